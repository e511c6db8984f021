// Connections: what the server keeps of each open connection, in places taken at start.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "service/address_book.hpp"
#include "service/gate.hpp"
#include "service/messages.hpp"

struct MHD_Connection;

namespace beltpick::service {

struct Connection {
  enum class Stage : std::uint8_t {
    kHead,      // the next request's head is awaited
    kBody,      // an admitted request's body comes
    kReadOver,  // a refused one's body comes and is dropped, so that the client gets to read why
    kWaits,     // in the slow lane
    kAnswered,
  };

  static constexpr std::int64_t kNever_us = std::numeric_limits<std::int64_t>::max();

  MHD_Connection* handle = nullptr;  // null: the place is free
  int fd = -1;
  ClientAddress from;
  std::uint64_t requests = 0;
  std::int64_t overdue_us = 0;  // when it is cut off; kNever_us: it was

  // The request that is under way; its names stay valid until it is answered.
  std::atomic<Stage> stage{Stage::kHead};
  Admission admission;
  std::string method, path, if_match;
  std::string body;  // of all but uploads
  ApiReply reply;
};

class Connections {
 public:
  explicit Connections(std::size_t places) : places_(places) {}

  // A free place; null where there is none.
  Connection* take();
  // Forgets the request: the place waits for the next one.
  static void next_request(Connection& connection);

  // The bytes of all answers that clients have not taken yet.
  [[nodiscard]] std::size_t answer_bytes() const;

  template <class Do>
  void for_each(Do act) {
    for (Connection& connection : places_) {
      if (connection.handle != nullptr) act(connection);
    }
  }

 private:
  std::vector<Connection> places_;
};

}  // namespace beltpick::service
