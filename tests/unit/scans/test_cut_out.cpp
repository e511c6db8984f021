#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "scans/cut_out.hpp"
#include "scans/organise.hpp"

using namespace beltpick;

namespace {

// An image of 200 x 100 pixels, 1 mm each, of a belt 500 mm away on which boxes 20 mm high stand.
struct Boxes {
  static constexpr int kRows = 100, kCols = 200;
  std::vector<Vec3f> point_mm;
  std::vector<std::uint16_t> label = std::vector<std::uint16_t>(kRows * kCols, 0);
  std::vector<Segment> segments;

  Boxes() {
    for (int row = 0; row < kRows; ++row) {
      for (int col = 0; col < kCols; ++col)
        point_mm.emplace_back(static_cast<float>(col), static_cast<float>(row), 500.0F);
    }
  }
  void add(int row_min, int row_max, int col_min, int col_max) {
    Segment segment{.label = static_cast<std::uint16_t>(segments.size() + 1)};
    segment.row_min = row_min, segment.row_max = row_max, segment.col_min = col_min, segment.col_max = col_max;
    for (int row = row_min; row <= row_max; ++row) {
      for (int col = col_min; col <= col_max; ++col) {
        point_mm[static_cast<std::size_t>(row * kCols + col)].z() = 480.0F;
        label[static_cast<std::size_t>(row * kCols + col)] = segment.label;
        ++segment.pixels;
      }
    }
    segments.push_back(segment);
  }
  // Nothing was measured there: a shadow.
  void darken(int row_min, int row_max, int col_min, int col_max) {
    for (int row = row_min; row <= row_max; ++row) {
      for (int col = col_min; col <= col_max; ++col) point_mm[static_cast<std::size_t>(row * kCols + col)].z() = 0.0F;
    }
  }
  [[nodiscard]] Result<scans::CutOut> cut_out() {
    const segment::Segmented objects{{label.data(), kRows, kCols}, segments, Plane{-Vec3::UnitZ(), -500.0}, 0};
    return scans::cut_out_part({{point_mm.data(), kRows, kCols}, {}, {}}, objects, "scan");
  }
};

}  // namespace

TEST_CASE("the pieces that a shadow parts are one part, crumbs elsewhere are left aside", "[scans]") {
  Boxes boxes;
  boxes.add(20, 60, 20, 60);
  boxes.add(20, 60, 70, 100);
  boxes.darken(15, 65, 61, 69);
  boxes.add(90, 93, 180, 183);
  const auto part = boxes.cut_out();
  REQUIRE(part.has_value());
  CHECK(part->labels == std::vector<std::uint16_t>{1, 2});
  CHECK(part->pixels == 41 * 41 + 41 * 31);
  CHECK(part->left_aside == 1);
}

TEST_CASE("two parts with belt between them are refused, and a bare belt", "[scans]") {
  Boxes boxes;
  REQUIRE_FALSE(boxes.cut_out().has_value());
  CHECK(boxes.cut_out().error().code == ResultCode::kNothingFound);
  boxes.add(20, 60, 20, 60);
  boxes.add(20, 60, 80, 120);
  const auto part = boxes.cut_out();
  REQUIRE_FALSE(part.has_value());
  CHECK(part.error().code == ResultCode::kUsage);
  CHECK(part.error().text().find("found 2 objects") != std::string_view::npos);
}

TEST_CASE("a point cloud is laid into the pixels of a camera that sees its points", "[scans]") {
  Mesh cloud;
  for (int row = 0; row < 60; ++row) {
    for (int col = 0; col < 80; ++col)
      cloud.vertex_mm.emplace_back(0.5F * static_cast<float>(col) - 20.0F, 0.5F * static_cast<float>(row) - 15.0F,
                                   400.0F);
  }
  auto image = scans::organise(cloud, "cloud.ply");
  REQUIRE(image.has_value());
  const RangeImage range = image->view();
  int measured = 0;
  for (int row = 0; row < range.point_mm.rows; ++row) {
    for (int col = 0; col < range.point_mm.cols; ++col) measured += range.valid(row, col) ? 1 : 0;
  }
  CHECK(measured > 3000);
  // Most pixels of the rectangle are filled: the pixels suit the points.
  CHECK(measured > 0.8 * (range.point_mm.rows - 8) * (range.point_mm.cols - 8));
  cloud.vertex_mm.front().z() = -1.0F;
  CHECK(scans::organise(cloud, "cloud.ply").error().code == ResultCode::kFormatInvalid);
}
