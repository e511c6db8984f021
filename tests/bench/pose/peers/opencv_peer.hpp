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

  // The poses with most votes, best first. Needs no start.
  [[nodiscard]] std::vector<PartPose> propose(const PeerObject& object, std::size_t most) const;

  // OpenCV's own ICP from each, the one that fits best. At least one pose.
  [[nodiscard]] PeerFit refine(const PeerObject& object, const std::vector<PartPose>& poses) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace beltpick::bench
