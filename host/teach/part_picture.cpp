#include "teach/part_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "teach/cones.hpp"

namespace beltpick::teach {

namespace {

using contract_io::Rgb;

constexpr Rgb kBackground{250, 250, 248};
constexpr Rgb kPlain{176, 180, 186};
constexpr Rgb kGraspColour{20, 20, 20};
constexpr Rgb kMarked{214, 40, 40};
constexpr std::array<Rgb, 16> kColours{{{230, 92, 70},
                                        {66, 135, 245},
                                        {82, 176, 96},
                                        {240, 176, 48},
                                        {160, 96, 200},
                                        {60, 180, 190},
                                        {214, 110, 160},
                                        {140, 120, 80},
                                        {150, 40, 40},
                                        {40, 70, 150},
                                        {30, 100, 50},
                                        {150, 210, 90},
                                        {255, 150, 200},
                                        {90, 60, 130},
                                        {120, 210, 235},
                                        {200, 190, 60}}};
// An orthographic view that a part's box fits into.
class View {
 public:
  View(const PartTemplate& part, const Mat3& looking, int rows, int cols)
      : rows_(rows), cols_(cols), x_(looking.row(0)), y_(looking.row(1)), z_(looking.row(2)) {
    middle_ = 0.5 * (part.box_min_mm + part.box_max_mm);
    double half_width = 1e-3;
    double half_height = 1e-3;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at((corner & 1) != 0 ? part.box_max_mm.x() : part.box_min_mm.x(),
                    (corner & 2) != 0 ? part.box_max_mm.y() : part.box_min_mm.y(),
                    (corner & 4) != 0 ? part.box_max_mm.z() : part.box_min_mm.z());
      half_width = std::max(half_width, std::abs((at - middle_).dot(x_)));
      half_height = std::max(half_height, std::abs((at - middle_).dot(y_)));
    }
    scale_ = 0.45 * std::min(cols / half_width, rows / half_height);
  }

  // Column, row and depth of a point of the part.
  [[nodiscard]] Vec3 project(const Vec3& point_mm) const {
    const Vec3 arm = point_mm - middle_;
    return {0.5 * cols_ + scale_ * arm.dot(x_), 0.5 * rows_ + scale_ * arm.dot(y_), arm.dot(z_)};
  }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] const Vec3& direction() const { return z_; }

 private:
  int rows_;
  int cols_;
  Vec3 x_, y_, z_, middle_;
  double scale_ = 1.0;
};

struct Canvas {
  explicit Canvas(int rows, int cols)
      : picture{rows, cols,
                std::vector<Rgb>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), kBackground)},
        depth(picture.pixels.size(), std::numeric_limits<double>::max()) {}

  void disc(const Vec3& at, double radius_px, const Rgb& colour) {
    const int reach = static_cast<int>(std::ceil(radius_px));
    for (int r = -reach; r <= reach; ++r) {
      for (int c = -reach; c <= reach; ++c) {
        const int row = static_cast<int>(std::lround(at.y())) + r;
        const int col = static_cast<int>(std::lround(at.x())) + c;
        if (r * r + c * c > radius_px * radius_px + 0.5 || row < 0 || col < 0 || row >= picture.rows ||
            col >= picture.cols)
          continue;
        const auto index =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.cols) + static_cast<std::size_t>(col);
        if (at.z() >= depth[index]) continue;
        depth[index] = at.z();
        picture.pixels[index] = colour;
      }
    }
  }

  Picture picture;
  std::vector<double> depth;
};

Rgb shaded(const Rgb& colour, double light) {
  Rgb result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = static_cast<std::uint8_t>(std::clamp(colour[k] * light, 0.0, 255.0));
  return result;
}

void draw_segment(Canvas& canvas, const View& view, const Vec3& from_mm, const Vec3& to_mm) {
  constexpr int kSteps = 200;
  for (int k = 0; k <= kSteps; ++k) {
    Vec3 at = view.project(from_mm + (to_mm - from_mm) * k / kSteps);
    at.z() -= 1e4;  // over everything
    canvas.disc(at, 1.0, kGraspColour);
  }
}

// The jaws as two short lines along the way in, joined above the part.
void draw_grasp(Canvas& canvas, const View& view, const Grasp& grasp) {
  const auto& T = grasp.T_part_gripper;
  const double half = 0.5 * grasp.opening_mm;
  constexpr double kLength_mm = 25.0;
  draw_segment(canvas, view, T * Vec3(-half, 0, -kLength_mm), T * Vec3(-half, 0, 0));
  draw_segment(canvas, view, T * Vec3(half, 0, -kLength_mm), T * Vec3(half, 0, 0));
  draw_segment(canvas, view, T * Vec3(-half, 0, -kLength_mm), T * Vec3(half, 0, -kLength_mm));
}

}  // namespace

contract_io::Rgb primitive_colour(std::size_t index) { return kColours[index % kColours.size()]; }

Mat3 looking_along(const Vec3& direction) {
  const Vec3 z = direction.normalized();
  const Vec3 up = std::abs(z.z()) < 0.95 ? Vec3::UnitZ() : Vec3::UnitY();
  const Vec3 x = z.cross(up).normalized();
  Mat3 looking;
  looking << x.transpose(), z.cross(x).transpose(), z.transpose();
  return looking;
}

std::vector<Rgb> colours_of_primitives(const Taught& taught) {
  const PartTemplate& part = taught.part;
  std::vector<Rgb> colours(part.point_mm.size(), kPlain);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const Vec3 point = part.point_mm[i].cast<double>();
    const Vec3 normal = part.normal[i].cast<double>();
    const int primitive = primitive_of(part.primitives, point, normal);
    if (primitive >= 0) colours[i] = primitive_colour(static_cast<std::size_t>(primitive));
    for (std::size_t c = 0; primitive < 0 && c < part.cones.size(); ++c) {
      if (on_cone(part.cones[c], point, normal)) colours[i] = primitive_colour(part.primitives.size() + c);
    }
  }
  return colours;
}

std::vector<Rgb> colours_of_marks(const std::vector<bool>& marked) {
  std::vector<Rgb> colours;
  for (const bool mark : marked) colours.push_back(mark ? kMarked : kPlain);
  return colours;
}

Picture draw_part(const Taught& taught, const Mat3& looking, const std::vector<Rgb>& colours, std::size_t grasps,
                  int rows, int cols) {
  const View view(taught.part, looking, rows, cols);
  Canvas canvas(rows, cols);
  const Vec3 light =
      (-view.direction() - 0.4 * looking.row(1).transpose() - 0.3 * looking.row(0).transpose()).normalized();
  const double radius_px = std::max(1.0, 0.95 * taught.part.spacing_mm * view.scale());
  for (std::size_t i = 0; i < taught.part.point_mm.size(); ++i) {
    const Vec3 normal = taught.part.normal[i].cast<double>();
    if (normal.dot(view.direction()) > 0) continue;
    const Vec3 point = taught.part.point_mm[i].cast<double>();
    canvas.disc(view.project(point), radius_px, shaded(colours[i], 0.35 + 0.65 * std::max(0.0, normal.dot(light))));
  }
  for (std::size_t g = 0; g < std::min(grasps, taught.part.grasps.size()); ++g)
    draw_grasp(canvas, view, taught.part.grasps[g]);
  return std::move(canvas.picture);
}

}  // namespace beltpick::teach
