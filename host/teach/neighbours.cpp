#include "teach/neighbours.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

namespace beltpick::teach {

struct NeighbourIndex::Tree {
  explicit Tree(const std::vector<Vec3f>& points)
      : matrix(const_cast<float*>(points.front().data()), points.size(),
               3),  // FLANN takes no const, and writes nothing
        index(matrix, flann::KDTreeSingleIndexParams(10)) {
    index.buildIndex();
  }
  flann::Matrix<float> matrix;
  flann::Index<flann::L2_Simple<float>> index;
};

NeighbourIndex::NeighbourIndex(const std::vector<Vec3f>& points) : tree_(std::make_unique<Tree>(points)) {}
NeighbourIndex::~NeighbourIndex() = default;

void NeighbourIndex::nearest(const Vec3f& query_mm, std::span<Neighbour> out) const {
  constexpr std::size_t kMost = 32;
  std::array<std::size_t, kMost> indices{};
  std::array<float, kMost> distances{};
  Vec3f query = query_mm;
  flann::Matrix<float> query_matrix(query.data(), 1, 3);
  flann::Matrix<std::size_t> index_matrix(indices.data(), 1, out.size());
  flann::Matrix<float> distance_matrix(distances.data(), 1, out.size());
  tree_->index.knnSearch(query_matrix, index_matrix, distance_matrix, out.size(), flann::SearchParams(-1));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {static_cast<std::uint32_t>(indices[i]), distances[i]};
}

}  // namespace beltpick::teach
