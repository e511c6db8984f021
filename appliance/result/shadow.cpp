#include "result/shadow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/kernel.hpp"

namespace beltpick::result {
namespace {

// Cells are as wide as so many pixels, and every second pixel is cast: several fall into each cell.
constexpr int kCell_px = 4;
constexpr int kStep_px = 2;
// Within this cosine of grazing light a cell's depth tells nothing.
constexpr float kLeastCosine = 0.1F;
// A surface ends where the next one lies so much lower.
constexpr float kLeastSide_mm = 5.0F;

// What look() needs, as plain numbers.
struct LightView {
  std::array<float, 3> light_mm;
  std::array<float, 9> turn;  // row by row
  float tan_left, tan_top, cells_per_tan;
  int rows, cols;
};

[[gnu::always_inline]] inline int within(float at, int size) {
  const float from_first = at > 0.0F ? at : 0.0F;
  const auto last = static_cast<float>(size - 1);
  return static_cast<int>(from_first < last ? from_first : last);
}

// look() for the points of a block: the index of each one's cell, -1 beyond the map, and its distance from the light.
BELTPICK_KERNEL void look_at_cells(const PointBlock& at, const LightView& v, std::size_t count, int* __restrict cell,
                                   float* __restrict distance_mm) {
  for (std::size_t i = 0; i < count; i += PointBlock::kLanes) {
    for (std::size_t k = i; k < i + PointBlock::kLanes; ++k) {
      const float dx = at.x[k] - v.light_mm[0], dy = at.y[k] - v.light_mm[1], dz = at.z[k] - v.light_mm[2];
      const float x = v.turn[0] * dx + (v.turn[1] * dy + v.turn[2] * dz);
      const float y = v.turn[3] * dx + (v.turn[4] * dy + v.turn[5] * dz);
      const float z = v.turn[6] * dx + (v.turn[7] * dy + v.turn[8] * dz);
      const float down = (y / z - v.tan_top) * v.cells_per_tan;
      const float right = (x / z - v.tan_left) * v.cells_per_tan;
      const bool on_map = (z > 0.0F) & (down >= 0.0F) & (right >= 0.0F) & (down < static_cast<float>(v.rows)) &
                          (right < static_cast<float>(v.cols));
      const int index = within(down, v.rows) * v.cols + within(right, v.cols);
      cell[k] = on_map ? index : -1;
      distance_mm[k] = std::sqrt(x * x + (y * y + z * z));
    }
  }
}

}  // namespace

ShadowMap::ShadowMap(Arena& arena, const Limits& limits) {
  const auto cells = static_cast<std::size_t>(limits.image_height / kCell_px + 1) *
                     static_cast<std::size_t>(limits.image_width / kCell_px + 1);
  memory_ = arena.take<float>("result: shadows", cells);
  bridged_ = arena.take<float>("result: shadows", cells);
}

void ShadowMap::cast(const RangeImage& range, const std::optional<Vec3>& light_mm, const std::optional<Plane>& belt) {
  light_mm_.reset();
  if (!light_mm) return;
  light_mm_ = light_mm->cast<float>();
  lit_mm_ = {memory_.data(), range.point_mm.rows / kCell_px + 1, range.point_mm.cols / kCell_px + 1};
  std::fill(memory_.begin(), memory_.end(), 0.0F);
  aim(range);
  if (!light_mm_) return;
  PointBlock points;
  int count = 0;
  for (int row = 0; row < range.point_mm.rows; row += kStep_px) {
    for (int col = 0; col < range.point_mm.cols; col += kStep_px) {
      if (!range.valid(row, col)) continue;
      points.put({range.point_mm(row, col), Vec3f::Zero()}, count++);
      if (count == PointBlock::kSize) stop_light(points, std::exchange(count, 0));
    }
  }
  stop_light(points, count);
  if (belt) stop_at_sides(range, *belt);
  bridge_gaps();
}

void ShadowMap::add(const PartModel& model, const Pose<frame::Camera, frame::Part>& T_camera_part) {
  if (!light_mm_) return;
  const FastMotion motion(T_camera_part);
  PointBlock points;
  for (std::size_t block = 0; block < model.fine.blocks.size(); ++block) {
    const auto count =
        static_cast<int>(std::min<std::size_t>(PointBlock::kSize, model.fine.count - block * PointBlock::kSize));
    move_points(model.fine.blocks[block], motion, count, points);
    stop_light(points, count);
  }
}

void ShadowMap::stop_light(const Vec3f& point_mm) {
  const Cell cell = look(point_mm);
  if (cell.row < 0) return;
  float& nearest = lit_mm_(cell.row, cell.col);
  if (nearest == 0.0F || cell.distance_mm < nearest) nearest = cell.distance_mm;
}

void ShadowMap::stop_light(PointBlock& points, int count) {
  points.fill_up(count);
  LightView view{{light_mm_->x(), light_mm_->y(), light_mm_->z()},
                 {},
                 tan_left_,
                 tan_top_,
                 cells_per_tan_,
                 lit_mm_.rows,
                 lit_mm_.cols};
  for (int i = 0; i < 9; ++i) view.turn[static_cast<std::size_t>(i)] = R_light_camera_(i / 3, i % 3);
  alignas(64) std::array<int, PointBlock::kSize> cell;
  alignas(64) PointBlock::Row distance_mm;
  look_at_cells(points, view, static_cast<std::size_t>(PointBlock::whole_steps(count)), cell.data(),
                distance_mm.data());
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    if (cell[k] < 0) continue;
    float& nearest = lit_mm_.data[cell[k]];
    if (nearest == 0.0F || distance_mm[k] < nearest) nearest = distance_mm[k];
  }
}

void ShadowMap::stop_at_sides(const RangeImage& range, const Plane& belt) {
  const Vec3f down = -belt.normal.cast<float>();
  const auto height_mm = [&](const Vec3f& at) { return -down.dot(at) - static_cast<float>(belt.offset_mm); };
  const float step_mm = (middle_mm_ - *light_mm_).norm() / cells_per_tan_;
  for (int row = kStep_px; row + kStep_px < range.point_mm.rows; row += kStep_px) {
    for (int col = kStep_px; col + kStep_px < range.point_mm.cols; col += kStep_px) {
      if (!range.valid(row, col)) continue;
      const Vec3f& at = range.point_mm(row, col);
      const float height = height_mm(at);
      if (height < kLeastSide_mm) continue;
      const auto ends = [&](int r, int c) {
        return !range.valid(r, c) || height_mm(range.point_mm(r, c)) < height - kLeastSide_mm;
      };
      if (!ends(row - kStep_px, col) && !ends(row + kStep_px, col) && !ends(row, col - kStep_px) &&
          !ends(row, col + kStep_px))
        continue;
      for (float below = step_mm; below < height; below += step_mm) stop_light(at + below * down);
    }
  }
}

// Turns the light to the middle of what was measured, and fits the cells to all of it.
void ShadowMap::aim(const RangeImage& range) {
  Vec3f sum = Vec3f::Zero();
  int count = 0;
  constexpr int kCoarse_px = 8;
  const auto each = [&](auto&& visit) {
    for (int row = 0; row < range.point_mm.rows; row += kCoarse_px) {
      for (int col = 0; col < range.point_mm.cols; col += kCoarse_px) {
        if (range.valid(row, col)) visit(range.point_mm(row, col));
      }
    }
  };
  each([&](const Vec3f& point) { sum += point, ++count; });
  if (count == 0) {
    light_mm_.reset();
    return;
  }
  middle_mm_ = sum / static_cast<float>(count);
  const Vec3f z = (middle_mm_ - *light_mm_).normalized();
  const Vec3f x = (Vec3f::UnitX() - z * z.x()).normalized();
  R_light_camera_ << x.transpose(), z.cross(x).transpose(), z.transpose();
  float left = 0.0F, right = 0.0F, top = 0.0F, bottom = 0.0F;
  each([&](const Vec3f& point) {
    const Vec3f p = R_light_camera_ * (point - *light_mm_);
    if (p.z() <= 0.0F) return;
    left = std::min(left, p.x() / p.z()), right = std::max(right, p.x() / p.z());
    top = std::min(top, p.y() / p.z()), bottom = std::max(bottom, p.y() / p.z());
  });
  tan_left_ = left;
  tan_top_ = top;
  cells_per_tan_ = std::min(static_cast<float>(lit_mm_.cols) / std::max(right - left, 1e-6F),
                            static_cast<float>(lit_mm_.rows) / std::max(bottom - top, 1e-6F));
}

ShadowMap::Cell ShadowMap::look(const Vec3f& point_mm) const {
  const Vec3f p = R_light_camera_ * (point_mm - *light_mm_);
  if (p.z() <= 0.0F) return {};
  const float down = (p.y() / p.z() - tan_top_) * cells_per_tan_;
  const float right = (p.x() / p.z() - tan_left_) * cells_per_tan_;
  if (!(down >= 0.0F && right >= 0.0F)) return {};
  const int row = static_cast<int>(down);
  const int col = static_cast<int>(right);
  if (!lit_mm_.contains(row, col)) return {};
  return {row, col, p.norm()};
}

// A surface that leans away from the camera, but not from the light, is measured sparsely: a cell that got nothing
// takes the farther of two cells that face each other across it.
void ShadowMap::bridge_gaps() {
  std::copy(memory_.begin(), memory_.end(), bridged_.begin());
  const ImageView<float> bridged{bridged_.data(), lit_mm_.rows, lit_mm_.cols};
  for (int row = 1; row + 1 < lit_mm_.rows; ++row) {
    for (int col = 1; col + 1 < lit_mm_.cols; ++col) {
      if (lit_mm_(row, col) > 0.0F) continue;
      const float above = lit_mm_(row - 1, col), below = lit_mm_(row + 1, col);
      const float before = lit_mm_(row, col - 1), after = lit_mm_(row, col + 1);
      if (above > 0.0F && below > 0.0F) bridged(row, col) = std::max(above, below);
      if (before > 0.0F && after > 0.0F) bridged(row, col) = std::max(before, after);
    }
  }
  lit_mm_ = bridged;
}

bool ShadowMap::hides(const Vec3f& point_mm, const Vec3f& normal, float margin_mm) const {
  if (!light_mm_) return false;
  const Cell cell = look(point_mm);
  if (cell.row < 0) return false;
  const float nearest = lit_mm_(cell.row, cell.col);
  if (nearest == 0.0F) return false;
  // The surface itself spreads over a cell, the more the flatter the light falls on it.
  const float cosine = std::abs(normal.dot(point_mm - *light_mm_)) / cell.distance_mm;
  const float spread_mm = cell.distance_mm / cells_per_tan_ / std::max(cosine, kLeastCosine);
  return nearest < cell.distance_mm - margin_mm - spread_mm;
}

}  // namespace beltpick::result
