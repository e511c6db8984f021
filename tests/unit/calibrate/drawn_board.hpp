// A chessboard drawn into an image, with its corners known exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "base/image.hpp"
#include "base/random.hpp"
#include "calibrate/observations.hpp"

namespace beltpick::test {

struct DrawnBoard {
  calibrate::Board board;
  Eigen::Matrix3d image_from_plate = Eigen::Matrix3d::Identity();  // squares to pixels
  int rows = 240, cols = 320;
  std::vector<float> levels;

  [[nodiscard]] ImageView<const float> view() const { return {levels.data(), rows, cols}; }
  [[nodiscard]] PixelPosition corner(int column, int row) const {
    const Eigen::Vector2d at = (image_from_plate * Eigen::Vector3d(column, row, 1.0)).hnormalized();
    return {at.x(), at.y()};
  }
};

// Turned by `angle_rad` and seen askew; `square_px` a square's side about the middle. The square between the first four
// inner corners is dark. Pixel and lens together blur by 0.6 pixels; the
// places of a pixel that are looked at lie irregularly, or edges along its rows would jump from one to the next.
inline DrawnBoard draw_board(const calibrate::Board& board, double angle_rad, double square_px, double noise = 0.0) {
  DrawnBoard drawn{board, {}, 240, 320, {}};
  Eigen::Matrix3d centre = Eigen::Matrix3d::Identity();
  centre.topRightCorner<2, 1>() = -0.5 * Eigen::Vector2d(board.columns - 1, board.rows - 1);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = square_px * Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  Eigen::Matrix3d askew = Eigen::Matrix3d::Identity();
  askew.bottomLeftCorner<1, 2>() << 4e-4, -3e-4;
  Eigen::Matrix3d place = Eigen::Matrix3d::Identity();
  place.topRightCorner<2, 1>() << 158.3, 121.7;
  drawn.image_from_plate = place * askew * turn * centre;
  const Eigen::Matrix3d plate_from_image = drawn.image_from_plate.inverse();
  const auto level = [&](double column, double row) {
    const Eigen::Vector2d at = (plate_from_image * Eigen::Vector3d(column, row, 1.0)).hnormalized();
    const int x = static_cast<int>(std::floor(at.x()));
    const int y = static_cast<int>(std::floor(at.y()));
    const bool printed = x >= -1 && x < board.columns && y >= -1 && y < board.rows;
    const double light = 1.0 + 0.0008 * column - 0.0005 * row;
    return (printed && (x + y) % 2 == 0 ? 30.0 : 190.0) * light;
  };
  Random random(1);
  constexpr int kFine = 14;
  constexpr double kReach_px = 4.0, kBlur_px = 0.6;
  for (int row = 0; row < drawn.rows; ++row) {
    for (int col = 0; col < drawn.cols; ++col) {
      double sum = 0.0, weights = 0.0;
      for (int i = 0; i < kFine * kFine; ++i) {
        const double x = kReach_px * ((i % kFine + random.uniform()) / kFine - 0.5);
        const double y = kReach_px * ((i / kFine + random.uniform()) / kFine - 0.5);
        const double weight = std::exp(-0.5 * (x * x + y * y) / (kBlur_px * kBlur_px));
        sum += weight * level(col + x, row + y);
        weights += weight;
      }
      drawn.levels.push_back(static_cast<float>(sum / weights + noise * (random.uniform() - 0.5)));
    }
  }
  return drawn;
}

}  // namespace beltpick::test
