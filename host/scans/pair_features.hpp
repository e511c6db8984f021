// Relative poses of two scans without a start: pairs of oriented points that look alike in both vote for the pose that
// lays one on the other (point pair features: Drost et al., Model Globally, Match Locally, 2010).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scans/scan_view.hpp"

namespace beltpick::scans {

struct VotedPose {
  CrossPose T_model_scan;
  int votes = 0;
};

// The pairs of one scan, by what they look like.
class PairTable {
 public:
  // `size_mm`: of the part; distances are told apart in steps of a share of it. Keeps a reference to nothing.
  PairTable(const ScanView& model, double size_mm);

  // The poses that most pairs of `scan` vote for, best first, none within a step of a better one.
  [[nodiscard]] std::vector<VotedPose> vote(const ScanView& scan, std::size_t most) const;

 private:
  struct Entry {
    std::uint16_t reference;
    float angle;  // of the other point about the reference's normal
  };
  struct Feature {
    std::uint32_t key;
    float angle;
  };
  using Points = std::vector<OrientedPoint>;

  [[nodiscard]] Points thin(const ScanView& view) const;
  [[nodiscard]] bool feature(const OrientedPoint& reference, const OrientedPoint& other, Feature& out) const;
  void vote_of_reference(const Points& points, std::size_t reference, std::vector<std::uint16_t>& votes,
                         std::vector<VotedPose>& out) const;

  double size_mm_;
  Points points_;
  std::vector<std::uint32_t> first_;  // of each key, into entries_; one more than keys
  std::vector<Entry> entries_;
};

}  // namespace beltpick::scans
