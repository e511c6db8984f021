#include "base/closest_point_tree.hpp"

#include <nanoflann.hpp>

namespace beltpick {
namespace {

// How nanoflann reads the points where they lie.
struct PointsInPlace {
  std::span<const OrientedPoint> points;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index].point_mm[static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointsInPlace>, PointsInPlace, 3,
                                                  std::uint32_t>;

}  // namespace

struct ClosestPointTree::Tree {
  explicit Tree(std::span<const OrientedPoint> points)
      : in_place{points}, index(3, in_place, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    index.buildIndex();
  }
  PointsInPlace in_place;
  Index index;
};

ClosestPointTree::ClosestPointTree(std::span<const OrientedPoint> points) : tree_(std::make_unique<Tree>(points)) {}
ClosestPointTree::~ClosestPointTree() = default;

std::uint32_t ClosestPointTree::nearest(const Vec3f& at_mm) const {
  std::uint32_t index = 0;
  float distance2 = 0.0F;
  tree_->index.knnSearch(at_mm.data(), 1, &index, &distance2);
  return index;
}

}  // namespace beltpick
