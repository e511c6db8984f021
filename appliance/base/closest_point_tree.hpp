// ClosestPointTree: the exact nearest point by a k-d tree (nanoflann), as the paper has it. Slower than the grid by an
// order of magnitude; kept to check it and to measure against it. Allocates when built, not when asked.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/pose.hpp"
#include "base/stages.hpp"

namespace beltpick {

class ClosestPointTree {
 public:
  // The points are the caller's and must outlive the tree; at least one.
  explicit ClosestPointTree(std::span<const OrientedPoint> points);
  ~ClosestPointTree();

  [[nodiscard]] std::uint32_t nearest(const Vec3f& at_mm) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace beltpick
