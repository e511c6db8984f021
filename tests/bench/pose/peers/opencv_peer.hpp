// OpenCV's surface_matching: point pair features (Drost et al. 2010), then its own ICP.
#pragma once

#include <memory>

#include "bench/pose/peers/peer_object.hpp"

namespace beltpick::bench {

class OpencvPpf {
 public:
  // Trains: some ten seconds.
  explicit OpencvPpf(const PartTemplate& part);
  ~OpencvPpf();
  OpencvPpf(OpencvPpf&&) noexcept;

  // Needs no start.
  [[nodiscard]] PeerFit match(const PeerObject& object) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace beltpick::bench
