#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <set>

#include "base/random.hpp"
#include "base/units.hpp"
#include "support/segmenting.hpp"

using namespace beltpick;

namespace {

constexpr int kRows = 240;
constexpr int kCols = 320;
constexpr double kFocal_px = 560.0;

// An image of a height field over a plane 700 mm away that leans by `lean_rad`: rays are marched down to the surface.
struct View {
  std::vector<Vec3f> points = std::vector<Vec3f>(static_cast<std::size_t>(kRows) * kCols, Vec3f::Zero());
  RangeImage image() { return {{points.data(), kRows, kCols}, {}, {}}; }

  View(const std::function<double(double, double)>& height_mm, double lean_rad, double noise_mm, std::uint64_t seed) {
    Random random(seed);
    const Mat3 lean = Eigen::AngleAxisd(lean_rad, Vec3::UnitX()).toRotationMatrix();
    for (int row = 0; row < kRows; ++row) {
      for (int col = 0; col < kCols; ++col) {
        const Vec3 ray((col - kCols / 2) / kFocal_px, (row - kRows / 2) / kFocal_px, 1.0);
        for (double z = 550; z < 900; z += 0.25) {
          const Vec3 at = lean.transpose() * (ray * z - Vec3(0, 0, 700));  // x, y in the plane, -z its height
          if (-at.z() > height_mm(at.x(), at.y())) continue;
          const double noise = noise_mm * (random.uniform() + random.uniform() + random.uniform() - 1.5) * 2.0;
          points[static_cast<std::size_t>(row) * kCols + col] = (ray * (z + noise)).cast<float>();
          break;
        }
      }
    }
  }
};

double boxes(double x, double y) {
  if (std::abs(x + 90) < 30 && std::abs(y) < 40) return 35;
  if (std::abs(x - 60) < 45 && std::abs(y + 30) < 25) return 20;
  return 0;
}

Limits small_limits() {
  Limits limits;
  limits.image_width = kCols;
  limits.image_height = kRows;
  limits.segments = 8;
  return limits;
}

}  // namespace

TEST_CASE("boxes on a leaning plane are one segment each, the plane is none", "[segment]") {
  const double lean_rad = GENERATE(0.0, 0.26, -0.4);
  const double noise_mm = GENERATE(0.03, 0.6);
  View view(boxes, lean_rad, noise_mm, 5);
  test::SegmenterWithMemory segmenter(small_limits());
  const auto found = segmenter->segment(view.image());
  REQUIRE(found.belt.has_value());
  const Vec3 normal = -(Eigen::AngleAxisd(lean_rad, Vec3::UnitX()).toRotationMatrix() * Vec3::UnitZ());
  CHECK(found.belt->normal.dot(normal) > std::cos(rad_from_deg(0.5)));
  REQUIRE(found.segments.size() == 2);
  CHECK(found.left_out == 0);
  std::set<float> tops{found.segments[0].top_mm, found.segments[1].top_mm};
  CHECK(*tops.begin() == Approx(20).margin(1.0 + 2 * noise_mm));
  CHECK(*tops.rbegin() == Approx(35).margin(1.0 + 2 * noise_mm));
}

TEST_CASE("an empty plane has no objects; nothing measured is no error", "[segment]") {
  test::SegmenterWithMemory segmenter(small_limits());
  View plane([](double, double) { return 0.0; }, 0.2, 0.3, 1);
  CHECK(segmenter->segment(plane.image()).segments.empty());
  View nothing([](double, double) { return -1e9; }, 0.0, 0.0, 1);
  const auto found = segmenter->segment(nothing.image());
  CHECK(found.segments.empty());
  CHECK_FALSE(found.belt.has_value());
}

TEST_CASE("the belt is the support even where a box's lid is larger", "[segment]") {
  View view([](double x, double y) { return std::abs(x) < 150 && std::abs(y) < 95 ? 60.0 : 0.0; }, 0.0, 0.05, 3);
  test::SegmenterWithMemory segmenter(small_limits());
  const auto found = segmenter->segment(view.image());
  REQUIRE(found.segments.size() == 1);
  CHECK(found.segments[0].top_mm == Approx(60).margin(1));
}

TEST_CASE("boxes that touch are cut apart at the crease between them, and only on demand", "[segment]") {
  // A block, and before it a flat one whose top runs up to its wall; the camera sees the wall.
  const auto touching = [](double x, double y) {
    if (std::abs(x) > 60) return 0.0;
    if (y < 0 && y > -50) return 55.0;
    return y >= 0 && y < 70 ? 20.0 : 0.0;
  };
  const double noise_mm = GENERATE(0.05, 0.3);
  View view(touching, -0.6, noise_mm, 2);
  test::SegmenterWithMemory segmenter(small_limits());
  CHECK(segmenter->segment(view.image()).segments.size() == 1);
  CHECK(segmenter->segment(view.image(), {.cut_creases = true}).segments.size() == 2);
}

TEST_CASE("a small step in a part is no reason to cut it", "[segment]") {
  const auto stepped = [](double x, double y) {
    if (std::abs(x) > 80 || std::abs(y) > 50) return 0.0;
    return std::hypot(x - 40, y) < 18 ? 40.0 : 25.0;  // a boss on a block: smaller than an object of its own
  };
  View view(stepped, 0.3, 0.05, 2);
  test::SegmenterWithMemory segmenter(small_limits());
  CHECK(segmenter->segment(view.image(), {.cut_creases = true}).segments.size() == 1);
}

TEST_CASE("more objects than the limit: the largest are kept and the rest counted", "[segment]") {
  const auto many = [](double x, double y) {
    const double size = 6.0 + 0.03 * (x + 200);
    return std::fmod(x + 1000, 40) < size && std::fmod(y + 1000, 40) < size ? 15.0 : 0.0;
  };
  View view(many, 0.0, 0.02, 2);
  test::SegmenterWithMemory segmenter(small_limits());
  const auto found = segmenter->segment(view.image());
  CHECK(found.segments.size() == 8);
  CHECK(found.left_out > 0);
  for (std::size_t i = 0; i < found.segments.size(); ++i) CHECK(found.segments[i].label == i + 1);
}

TEST_CASE("the same image gives the same labels", "[segment]") {
  View view(boxes, 0.3, 0.2, 9);
  test::SegmenterWithMemory first(small_limits());
  test::SegmenterWithMemory second(small_limits());
  const auto a = first->segment(view.image(), {.cut_creases = true});
  second->segment(View(boxes, 0.1, 0.5, 4).image());
  const auto b = second->segment(view.image(), {.cut_creases = true});
  REQUIRE(a.segments.size() == b.segments.size());
  CHECK(std::equal(a.labels.data, a.labels.data + a.labels.size(), b.labels.data));
}

TEST_CASE("a tall boss goes with its plate on demand, a box on a box of its size does not", "[segment]") {
  const double boss_mm = GENERATE(18.0, 40.0);
  const auto stacked = [boss_mm](double x, double y) {
    if (std::abs(x) > 80 || std::abs(y) > 60) return 0.0;
    return std::abs(x) < boss_mm && std::abs(y) < boss_mm ? 60.0 : 25.0;
  };
  View view(stacked, 0.0, 0.03, 2);
  test::SegmenterWithMemory segmenter(small_limits());
  CHECK(segmenter->segment(view.image()).segments.size() == 2);
  const std::size_t wanted = boss_mm < 20 ? 1 : 2;
  CHECK(segmenter->segment(view.image(), {.cut_creases = true, .join_fragments = true}).segments.size() == wanted);
}

TEST_CASE("an object without a plane to stand on is an object, not its own support", "[segment]") {
  View view([](double x, double y) { return std::hypot(x, y) < 55 ? std::sqrt(60.0 * 60.0 - x * x - y * y) : -1e9; },
            0.0, 0.05, 2);
  test::SegmenterWithMemory segmenter(small_limits());
  const auto found = segmenter->segment(view.image());
  CHECK_FALSE(found.belt.has_value());
  CHECK(found.segments.size() == 1);
}
