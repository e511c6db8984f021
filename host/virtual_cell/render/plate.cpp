#include "virtual_cell/render/plate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kFacetMm = 5.0;  // facets stray from a bow of 0.05 mm by less than a nanometre's tens

const char* what_is_wrong(const PlateOptions& o) {
  if (!(o.quiet_zone_mm >= 0.0 && o.quiet_zone_mm <= 200.0)) return "quiet zone: expected 0..200 mm";
  if (!(o.thickness_mm >= 1.0 && o.thickness_mm <= 50.0)) return "thickness: expected 1..50 mm";
  if (!(o.bend_mm >= 0.0 && o.bend_mm <= 5.0)) return "bend: expected 0..5 mm";
  return nullptr;
}

// Faces of a strip of quadrilaterals between two rows of vertices that begin at `a` and `b`, seen from outside with
// row a above row b.
void add_strip(Mesh& mesh, const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    mesh.face.push_back({a[i], b[i], b[i + 1]});
    mesh.face.push_back({a[i], b[i + 1], a[i + 1]});
  }
}

}  // namespace

Result<Plate> Plate::make(const PlateOptions& options, std::uint64_t seed) {
  if (const char* wrong = what_is_wrong(options))
    return failure(ResultCode::kValueOutOfRange, "plate: %s; correct the option", wrong);
  auto print = BoardPrint::make(options.board);
  if (!print) return std::unexpected(print.error());
  Plate plate(options, std::move(*print));
  Random random(seed, 31);
  const double angle = random.uniform(0.0, 2.0 * kPi);
  const double saddle = random.uniform(0.0, 0.8);
  plate.dome_ = random.uniform() < 0.5 ? 1.0 : -1.0;
  plate.saddle_ = saddle * std::cos(angle);
  plate.twist_ = saddle * std::sin(angle);
  const double half_x = 0.5 * options.board.width_mm() + options.quiet_zone_mm;
  const double half_y = 0.5 * options.board.height_mm() + options.quiet_zone_mm;
  constexpr int kSteps = 40;
  double low = 1e30, high = -1e30, sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const double z = plate.bend_shape(half_x * (2.0 * i / kSteps - 1.0), half_y * (2.0 * j / kSteps - 1.0));
      low = std::min(low, z);
      high = std::max(high, z);
      sum += z / ((kSteps + 1) * (kSteps + 1));
    }
  }
  plate.mean_ = sum;
  plate.scale_ = options.bend_mm / (high - low);
  return plate;
}

double Plate::bend_shape(double u_mm, double v_mm) const {
  return dome_ * (u_mm * u_mm + v_mm * v_mm) + saddle_ * (u_mm * u_mm - v_mm * v_mm) + 2.0 * twist_ * u_mm * v_mm;
}

Vec3 Plate::centre_mm() const {
  const Board& board = options_.board;
  return {0.5 * board.width_mm() - board.square_mm, 0.5 * board.height_mm() - board.square_mm, 0.0};
}

double Plate::bow_mm(double x_mm, double y_mm) const {
  const Vec3 centre = centre_mm();
  return scale_ * (bend_shape(x_mm - centre.x(), y_mm - centre.y()) - mean_);
}

std::vector<Vec3> Plate::corners_mm() const {
  std::vector<Vec3> corners;
  for (int row = 0; row < options_.board.rows; ++row) {
    for (int column = 0; column < options_.board.columns; ++column) {
      const double x = column * options_.board.square_mm;
      const double y = row * options_.board.square_mm;
      corners.emplace_back(x, y, bow_mm(x, y));
    }
  }
  return corners;
}

std::vector<Vec3> Plate::outline_mm(double inset_mm, int steps) const {
  const Vec3 half(0.5 * options_.board.width_mm() + options_.quiet_zone_mm - inset_mm,
                  0.5 * options_.board.height_mm() + options_.quiet_zone_mm - inset_mm, 0.0);
  const Vec3 centre = centre_mm();
  constexpr std::array<std::pair<int, int>, 4> kCorner{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  std::vector<Vec3> outline;
  for (std::size_t side = 0; side < 4; ++side) {
    const auto [from_x, from_y] = kCorner[side];
    const auto [to_x, to_y] = kCorner[(side + 1) % 4];
    for (int i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const Vec3 place(from_x + t * (to_x - from_x), from_y + t * (to_y - from_y), 0.0);
      Vec3 point = centre + half.cwiseProduct(place);
      point.z() = bow_mm(point.x(), point.y());
      outline.push_back(point);
    }
  }
  return outline;
}

Result<ScenePart> Plate::part() const {
  const double width = options_.board.width_mm() + 2.0 * options_.quiet_zone_mm;
  const double height = options_.board.height_mm() + 2.0 * options_.quiet_zone_mm;
  const int columns = std::max(2, static_cast<int>(std::lround(width / kFacetMm)));
  const int rows = std::max(2, static_cast<int>(std::lround(height / kFacetMm)));
  const Vec3 first = centre_mm() - Vec3(0.5 * width, 0.5 * height, 0.0);
  Mesh mesh;
  // Both faces bend alike. `face` 0 is the printed one, 1 the back.
  const auto vertex = [&](int face, int row, int column) {
    return static_cast<std::uint32_t>((face * (rows + 1) + row) * (columns + 1) + column);
  };
  for (int face = 0; face < 2; ++face) {
    for (int row = 0; row <= rows; ++row) {
      for (int column = 0; column <= columns; ++column) {
        Vec3 point = first + Vec3(width * column / columns, height * row / rows, 0.0);
        point.z() = bow_mm(point.x(), point.y()) + face * options_.thickness_mm;
        mesh.vertex_mm.push_back(point.cast<float>());
      }
    }
  }
  const auto along_row = [&](int face, int row, bool reversed) {
    std::vector<std::uint32_t> line;
    for (int c = 0; c <= columns; ++c) line.push_back(vertex(face, row, reversed ? columns - c : c));
    return line;
  };
  const auto along_column = [&](int face, int column, bool reversed) {
    std::vector<std::uint32_t> line;
    for (int r = 0; r <= rows; ++r) line.push_back(vertex(face, reversed ? rows - r : r, column));
    return line;
  };
  for (int row = 0; row < rows; ++row) {
    // The printed face looks along -z, where x runs right and y down; the back is seen mirrored.
    add_strip(mesh, along_row(0, row, false), along_row(0, row + 1, false));
    add_strip(mesh, along_row(1, row + 1, false), along_row(1, row, false));
  }
  add_strip(mesh, along_row(0, 0, true), along_row(1, 0, true));
  add_strip(mesh, along_row(0, rows, false), along_row(1, rows, false));
  add_strip(mesh, along_column(0, 0, false), along_column(1, 0, false));
  add_strip(mesh, along_column(0, columns, true), along_column(1, columns, true));
  auto part = make_part("plate", std::move(mesh));
  if (!part) return part;
  part->finish = Finish::kPrinted;
  part->print = std::make_shared<const BoardPrint>(print_);
  return part;
}

}  // namespace beltpick::virtual_cell
