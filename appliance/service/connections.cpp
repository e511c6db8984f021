#include "service/connections.hpp"

namespace beltpick::service {

Connection* Connections::take() {
  for (Connection& place : places_) {
    if (place.handle == nullptr) return &place;
  }
  return nullptr;
}

void Connections::next_request(Connection& connection) {
  connection.stage = Connection::Stage::kHead;
  connection.admission = {};
  connection.body.clear();
  connection.reply = {};
}

std::size_t Connections::answer_bytes() const {
  std::size_t bytes = 0;
  for (const Connection& place : places_) bytes += place.reply.body.size();
  return bytes;
}

}  // namespace beltpick::service
