// Spin images (Johnson and Hebert 1999): what lies round a surface point, by distance from its normal's line and height
// along it; and poses from points of an object and of a part whose spin images are alike.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/stages.hpp"
#include "contract/part_model.hpp"
#include "search/from_primitive.hpp"

namespace beltpick::bench {

struct SpinImage {
  static constexpr int kBins = 12;  // of either axis
  std::array<float, static_cast<std::size_t>(kBins) * kBins> at{};
};

// Parameters of the method, as shares of the part's diagonal where they are lengths.
struct SpinOptions {
  double support_share = 0.25;      // radius of the cylinder that an image covers; its height is twice that
  double support_cosine = 0.5;      // points whose normal leans away more than 60 degrees do not count
  std::size_t model_points = 1200;  // with an image, spread over the part
  std::size_t scene_points = 60;
  std::size_t matches = 8;   // kept of each scene point
  std::size_t pairs = 3000;  // of matches that agree, tried as poses
};

SpinImage spin_image(const OrientedPoint& about, std::span<const OrientedPoint> surface, double support_mm,
                     double support_cosine);

// Similarity of two images: the linear correlation over the bins that both fill, as Fisher's z, less what few common
// bins leave to chance.
float similarity(const SpinImage& a, const SpinImage& b);

// A part's images, made once.
class SpinModel {
 public:
  SpinModel(const PartModel& model, const SpinOptions& options);

  // Poses that bring pairs of alike points together, ranked by Q into the pool. `object`: all its sampled points.
  // Returns how many were tried.
  int search(std::span<const OrientedPoint> object, const search::SearchInput& input,
             search::HypothesisPool& pool) const;

 private:
  struct Match {
    const OrientedPoint* scene;
    const OrientedPoint* model;
    float similarity;
  };
  [[nodiscard]] std::vector<Match> matches(std::span<const OrientedPoint> object) const;
  [[nodiscard]] bool agree(const Match& a, const Match& b) const;

  const PartModel& model_;
  SpinOptions options_;
  double support_mm_;
  std::vector<OrientedPoint> points_;
  std::vector<SpinImage> images_;
};

}  // namespace beltpick::bench
