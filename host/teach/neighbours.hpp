// Nearest points of a point set (FLANN's single k-d tree).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/pose.hpp"

namespace beltpick::teach {

struct Neighbour {
  std::uint32_t index = 0;
  float squared_mm2 = 0.0F;
};

class NeighbourIndex {
 public:
  // Keeps a reference to `points`, which must not be empty.
  explicit NeighbourIndex(const std::vector<Vec3f>& points);
  ~NeighbourIndex();
  NeighbourIndex(const NeighbourIndex&) = delete;
  NeighbourIndex& operator=(const NeighbourIndex&) = delete;

  // Fills `out` with the out.size() nearest points, nearest first. There must be that many.
  void nearest(const Vec3f& query_mm, std::span<Neighbour> out) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace beltpick::teach
