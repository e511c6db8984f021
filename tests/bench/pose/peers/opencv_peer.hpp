// OpenCV's surface_matching: point pair features (Drost et al. 2010), then its own ICP.
#pragma once

#include <memory>

#include "bench/pose/peers/peer_object.hpp"

namespace beltpick::bench {

class OpencvPpf {
 public:
  // To be trained before it matches.
  explicit OpencvPpf(const PartTemplate& part);
  ~OpencvPpf();
  OpencvPpf(OpencvPpf&&) noexcept;

  // Takes some ten seconds a part.
  void train();

  // Needs no start.
  [[nodiscard]] PeerFit match(const PeerObject& object) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace beltpick::bench
