// Corners found in drawn boards, the projector's light at them, and the even image that both start from.
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "base/units.hpp"
#include "calibrate/board_corners.hpp"
#include "calibrate/flat_image.hpp"
#include "calibrate/projector_corners.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "drawn_board.hpp"

using namespace beltpick;
using namespace beltpick::test;
using calibrate::Board;

namespace {

double off_px(const PixelPosition& a, const PixelPosition& b) {
  return std::hypot(a.column_px - b.column_px, a.row_px - b.row_px);
}

// A code like that of a plate: projective in the camera's pixels. Black squares may be unreadable.
struct DrawnCode {
  std::vector<float> column_px, row_px, modulation;
  std::vector<std::uint8_t> texture;
  std::vector<PixelState> state;
  CodeImage image;

  static Eigen::Vector2d true_px(double column, double row) {
    const double w = 1.0 + 2e-4 * column - 1e-4 * row;
    return {(100.0 + 0.8 * column + 0.05 * row) / w, (50.0 - 0.03 * column + 1.1 * row) / w};
  }

  DrawnCode(const DrawnBoard& drawn, bool black_is_dark, double noise_px) {
    Random random(7);
    for (int row = 0; row < drawn.rows; ++row) {
      for (int col = 0; col < drawn.cols; ++col) {
        const float level = drawn.view()(row, col);
        const bool dark = black_is_dark && level < 80.0F;
        const Eigen::Vector2d at = true_px(col, row);
        const auto value = [&](double v) {
          const double noisy = v + noise_px * 3.46 * (random.uniform() - 0.5);
          return dark ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(noisy);
        };
        column_px.push_back(value(at.x()));
        row_px.push_back(value(at.y()));
        modulation.push_back(0.4F * level);
        texture.push_back(static_cast<std::uint8_t>(std::min(level, 255.0F)));
        state.push_back(dark ? PixelState::kDark : PixelState::kValid);
      }
    }
    image.column_px = {column_px.data(), drawn.rows, drawn.cols};
    image.row_px = {row_px.data(), drawn.rows, drawn.cols};
    image.modulation = {modulation.data(), drawn.rows, drawn.cols};
    image.texture = {texture.data(), drawn.rows, drawn.cols};
    image.state = {state.data(), drawn.rows, drawn.cols};
    image.column_noise = image.row_noise = {static_cast<float>(noise_px), 0.1F};
  }
};

}  // namespace

TEST_CASE("a chessboard's corners are found to hundredths of a pixel, numbered alike whichever way it is turned",
          "[calibrate]") {
  const Board board{7, 6, 20.0};
  for (const double angle_deg : {0.0, 25.0, 90.0, 160.0, 215.0}) {
    INFO("turned by " << angle_deg);
    const DrawnBoard drawn = draw_board(board, rad_from_deg(angle_deg), 21.3, 2.0);
    const auto found = calibrate::find_board(board, drawn.view());
    REQUIRE(found);
    REQUIRE(found->size() == 42);
    double worst_px = 0.0;
    for (const auto& corner : *found) {
      worst_px = std::max(
          worst_px, off_px(corner.at_px, drawn.corner(board.column_of(corner.corner), board.row_of(corner.corner))));
    }
    CHECK(worst_px < 0.045);  // the drawing's own coarseness is most of it
  }
}

TEST_CASE("a board that looks alike both ways is numbered rightwards in the image", "[calibrate]") {
  const Board board{7, 5, 20.0};
  CHECK(calibrate::is_symmetric(board));
  CHECK_FALSE(calibrate::is_symmetric({7, 6, 20.0}));
  for (const double angle_deg : {10.0, 170.0}) {
    const DrawnBoard drawn = draw_board(board, rad_from_deg(angle_deg), 21.3);
    const auto found = calibrate::find_board(board, drawn.view());
    REQUIRE(found);
    CHECK(found->front().at_px.column_px < (*found)[6].at_px.column_px);
  }
}

TEST_CASE("what is no such board is not found, and what can be none is refused", "[calibrate]") {
  const DrawnBoard drawn = draw_board({7, 6, 20.0}, 0.2, 21.0);
  const auto found = calibrate::find_board({9, 8, 20.0}, drawn.view());
  REQUIRE_FALSE(found);
  CHECK(found.error().code == ResultCode::kNothingFound);
  CHECK_FALSE(calibrate::check_board({2, 6, 20.0}));
  CHECK_FALSE(calibrate::check_board({7, 6, 0.0}));
  CHECK_FALSE(calibrate::check_board({7, 6, 20.0, 20.0, "DICT_4X4_50"}));
  CHECK_FALSE(calibrate::check_board({7, 6, 20.0, 15.0, "DICT_9X9"}));
  CHECK_FALSE(calibrate::check_board({30, 30, 20.0, 15.0, "DICT_4X4_50"}));
  CHECK(calibrate::check_board({7, 6, 20.0, 15.0, "DICT_4X4_50"}));
}

TEST_CASE("the light at a corner is fitted far below the noise of a pixel, also where black is too dark",
          "[calibrate]") {
  const Board board{7, 6, 20.0};
  for (const bool black_is_dark : {false, true}) {
    INFO("black is dark: " << black_is_dark);
    const DrawnBoard drawn = draw_board(board, 0.3, 22.0);
    const DrawnCode code(drawn, black_is_dark, 0.1);
    double worst_px = 0.0;
    for (int number = 0; number < board.corners(); ++number) {
      calibrate::ObservedCorner corner;
      corner.corner = number;
      corner.camera_px = drawn.corner(board.column_of(number), board.row_of(number));
      calibrate::fit_projector_corner(code.image, drawn.view(), 22.0, corner);
      REQUIRE(corner.has_projector());
      const Eigen::Vector2d truth = DrawnCode::true_px(corner.camera_px.column_px, corner.camera_px.row_px);
      worst_px = std::max(worst_px, off_px(corner.projector_px, {truth.x(), truth.y()}) / corner.projector_sigma_px);
      CHECK(corner.projector_sigma_px < 0.05);
      CHECK(corner.projector_by_camera(1, 1) == Approx(1.1).margin(0.05));
    }
    CHECK(worst_px < 5.0);  // of the predicted standard deviation
  }
}

TEST_CASE("a corner with unmeasured pixels all to one side has no light, and says so", "[calibrate]") {
  const DrawnBoard drawn = draw_board({7, 6, 20.0}, 0.0, 22.0);
  DrawnCode code(drawn, false, 0.05);
  calibrate::ObservedCorner corner;
  corner.camera_px = drawn.corner(3, 3);
  for (int row = 0; row < drawn.rows; ++row) {
    for (int col = 0; col < static_cast<int>(corner.camera_px.column_px) + 1; ++col) {
      code.image.column_px(row, col) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  calibrate::fit_projector_corner(code.image, drawn.view(), 22.0, corner);
  CHECK_FALSE(corner.has_projector());
  CHECK(std::isnan(corner.projector_px.column_px));
}

TEST_CASE("frames add up to even light", "[calibrate]") {
  const ProjectorGrid grid{64, 48};
  const auto sequence = make_sequence(SequenceName::kFast, grid, SequenceAxes::kBoth);
  REQUIRE(sequence);
  calibrate::FlatImage flat(*sequence, 48, 64, 255);
  for (std::size_t f = 0; f < sequence->frames.size(); ++f) {
    const FrameSpec& frame = sequence->frames[f];
    std::vector<std::uint8_t> levels;
    for (int row = 0; row < 48; ++row) {
      for (int col = 0; col < 64; ++col) {
        const double light = pattern_intensity(frame, frame.axis == Axis::kColumn ? col : row);
        levels.push_back(static_cast<std::uint8_t>(std::lround(20.0 + (col < 32 ? 50.0 : 200.0) * light)));
      }
    }
    flat.add(static_cast<int>(f), ImageView<const std::uint8_t>(levels.data(), 48, 64));
  }
  const auto image = flat.finish();
  for (int row = 0; row < 48; ++row) {
    for (int col = 0; col < 64; ++col) CHECK(image(row, col) == Approx(col < 32 ? 45.0 : 120.0).margin(0.6));
  }
}

TEST_CASE("of several exposures the longest is taken that saturates nothing", "[calibrate]") {
  Sequence sequence;
  sequence.projector = {8, 8};
  for (const double exposure_us : {1000.0, 2000.0, 8000.0}) {
    FrameSpec white;
    white.exposure_us = exposure_us;
    sequence.frames.push_back(white);
  }
  calibrate::FlatImage flat(sequence, 8, 8, 1000);
  const std::uint16_t levels[] = {200, 400, 1000};
  for (int f = 0; f < 3; ++f) {
    const std::vector<std::uint16_t> image(64, levels[f]);
    flat.add(f, ImageView<const std::uint16_t>(image.data(), 8, 8));
  }
  CHECK(flat.finish()(3, 3) == Approx(255.0 * 0.4));
}
