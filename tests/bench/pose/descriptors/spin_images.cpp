#include "bench/pose/descriptors/spin_images.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace beltpick::bench {
namespace {

// Johnson's lambda: the weight of the common bins' number.
constexpr float kOverlapWeight = 3.0F;

// A frame by two oriented points: x along what joins them, z as near to both normals as can be.
Mat3 frame_of(const OrientedPoint& a, const OrientedPoint& b) {
  const Vec3 x = (b.point_mm - a.point_mm).cast<double>().normalized();
  const Vec3 normal = (a.normal + b.normal).cast<double>();
  const Vec3 z = (normal - normal.dot(x) * x).normalized();
  Mat3 frame;
  frame << x, z.cross(x), z;
  return frame;
}

// Evenly spread over a list in no particular order: drawn without putting back.
std::vector<OrientedPoint> drawn(std::span<const OrientedPoint> from, std::size_t count, std::uint64_t seed) {
  std::vector<OrientedPoint> all(from.begin(), from.end());
  Random random(seed);
  count = std::min(count, all.size());
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(all[i], all[i + random.below(static_cast<std::uint32_t>(all.size() - i))]);
  }
  all.resize(count);
  return all;
}

}  // namespace

SpinImage spin_image(const OrientedPoint& about, std::span<const OrientedPoint> surface, double support_mm,
                     double support_cosine) {
  SpinImage image;
  const auto per_bin = static_cast<float>(SpinImage::kBins / support_mm);
  for (const OrientedPoint& point : surface) {
    if (about.normal.dot(point.normal) < static_cast<float>(support_cosine)) continue;
    const Vec3f arm = point.point_mm - about.point_mm;
    const float height = about.normal.dot(arm);
    const float radius = std::sqrt(std::max(0.0F, arm.squaredNorm() - height * height));
    // Twice the radius fits into the height: its bins are twice as high.
    const float column = radius * per_bin - 0.5F;
    const float row = 0.5F * (height * per_bin + SpinImage::kBins) - 0.5F;
    const int c = static_cast<int>(std::floor(column)), r = static_cast<int>(std::floor(row));
    for (int dr = 0; dr < 2; ++dr) {
      for (int dc = 0; dc < 2; ++dc) {
        if (r + dr < 0 || r + dr >= SpinImage::kBins || c + dc < 0 || c + dc >= SpinImage::kBins) continue;
        const float share = (1.0F - std::abs(row - static_cast<float>(r + dr))) *
                            (1.0F - std::abs(column - static_cast<float>(c + dc)));
        image.at[static_cast<std::size_t>((r + dr) * SpinImage::kBins + c + dc)] += share;
      }
    }
  }
  return image;
}

float similarity(const SpinImage& a, const SpinImage& b) {
  float n = 0.0F, sa = 0.0F, sb = 0.0F, saa = 0.0F, sbb = 0.0F, sab = 0.0F;
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    if (a.at[i] <= 0.0F || b.at[i] <= 0.0F) continue;
    n += 1.0F, sa += a.at[i], sb += b.at[i];
    saa += a.at[i] * a.at[i], sbb += b.at[i] * b.at[i], sab += a.at[i] * b.at[i];
  }
  if (n < 6.0F) return -1e3F;
  const float variance = (n * saa - sa * sa) * (n * sbb - sb * sb);
  const float correlation = variance > 0.0F ? (n * sab - sa * sb) / std::sqrt(variance) : 0.0F;
  const float z = std::atanh(std::clamp(correlation, -0.999F, 0.999F));
  return z * z * (z < 0.0F ? -1.0F : 1.0F) - kOverlapWeight / (n - 3.0F);
}

SpinModel::SpinModel(const PartModel& model, const SpinOptions& options)
    : model_(model), options_(options), support_mm_(options.support_share * model.diagonal_mm) {
  points_ = drawn(model.surface, options.model_points, 11);
  // As dense as an object is sampled: more adds time, not knowledge.
  const auto surface = drawn(model.surface, 6000, 12);
  for (const OrientedPoint& point : points_) {
    images_.push_back(spin_image(point, surface, support_mm_, options.support_cosine));
  }
}

std::vector<SpinModel::Match> SpinModel::matches(std::span<const OrientedPoint> object) const {
  std::vector<Match> all;
  for (const OrientedPoint& point : object.first(std::min(object.size(), options_.scene_points))) {
    const SpinImage image = spin_image(point, object, support_mm_, options_.support_cosine);
    std::vector<Match> of_point;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      of_point.push_back({&point, &points_[i], similarity(image, images_[i])});
    }
    const auto kept = static_cast<std::ptrdiff_t>(std::min(options_.matches, of_point.size()));
    std::partial_sort(of_point.begin(), of_point.begin() + kept, of_point.end(),
                      [](const Match& a, const Match& b) { return a.similarity > b.similarity; });
    all.insert(all.end(), of_point.begin(), of_point.begin() + kept);
  }
  return all;
}

bool SpinModel::agree(const Match& a, const Match& b) const {
  constexpr float kCosine = 0.2F;
  if (a.scene == b.scene || a.model == b.model) return false;
  const Vec3f in_scene = b.scene->point_mm - a.scene->point_mm;
  const Vec3f on_model = b.model->point_mm - a.model->point_mm;
  const auto apart = static_cast<float>(0.15 * model_.diagonal_mm);
  const auto slack = static_cast<float>(0.03 * model_.diagonal_mm);
  if (in_scene.norm() < apart || std::abs(in_scene.norm() - on_model.norm()) > slack) return false;
  const auto alike = [](float x, float y) { return std::abs(x - y) < kCosine; };
  return alike(a.scene->normal.dot(b.scene->normal), a.model->normal.dot(b.model->normal)) &&
         alike(a.scene->normal.dot(in_scene.normalized()), a.model->normal.dot(on_model.normalized())) &&
         alike(b.scene->normal.dot(in_scene.normalized()), b.model->normal.dot(on_model.normalized()));
}

int SpinModel::search(std::span<const OrientedPoint> object, const search::SearchInput& input,
                      search::HypothesisPool& pool) const {
  struct Pair {
    std::size_t a, b;
    float similarity;
  };
  const std::vector<Match> found = matches(object);
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < found.size(); ++a) {
    for (std::size_t b = a + 1; b < found.size(); ++b) {
      if (agree(found[a], found[b])) pairs.push_back({a, b, found[a].similarity + found[b].similarity});
    }
  }
  const std::size_t kept = std::min(options_.pairs, pairs.size());
  std::partial_sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(kept), pairs.end(),
                    [](const Pair& x, const Pair& y) { return x.similarity > y.similarity; });
  search::Trials trials(input, pool);
  for (std::size_t i = 0; i < kept; ++i) {
    const Match& a = found[pairs[i].a];
    const Match& b = found[pairs[i].b];
    const Mat3 rotation = frame_of(*a.scene, *b.scene) * frame_of(*a.model, *b.model).transpose();
    const Vec3 middle_scene = 0.5 * (a.scene->point_mm + b.scene->point_mm).cast<double>();
    const Vec3 middle_model = 0.5 * (a.model->point_mm + b.model->point_mm).cast<double>();
    trials.add({rotation, middle_scene - rotation * middle_model});
  }
  return static_cast<int>(kept);
}

}  // namespace beltpick::bench
