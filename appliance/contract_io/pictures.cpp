#include "contract_io/pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "contract/lens_project.hpp"

namespace beltpick::contract_io {
namespace {

std::uint8_t level(double value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)); }

// Hue in turns, full saturation.
Rgb rgb_from_hue(double hue, double value) {
  const auto channel = [&](double shift) {
    const double k = std::fmod(hue * 6.0 + shift, 6.0);
    return level(255.0 * value * (1.0 - std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

Rgb mix(const Rgb& a, const Rgb& b, double share_of_b) {
  Rgb out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = level(a[i] + share_of_b * (b[i] - a[i]));
  return out;
}

Rgb grey(std::uint8_t value) { return {value, value, value}; }

// Which pixels a part covers, by splatting the points of its surface that face the camera.
std::vector<std::uint8_t> silhouette(const PartTemplate& part, const Pose<frame::Camera, frame::Part>& T_camera_part,
                                     const Lens& camera, int rows, int cols) {
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(rows) * cols, 0);
  for (std::size_t i = 0; i < part.point_mm.size(); ++i) {
    const Vec3 at = T_camera_part * part.point_mm[i].cast<double>();
    if (!in_field(camera, at) || at.dot(T_camera_part.rotation * part.normal[i].cast<double>()) >= 0.0) continue;
    const PixelPosition where = project(camera, at);
    const int reach = std::max(1, static_cast<int>(std::lround(0.75 * part.spacing_mm * camera.fx_px / at.z())));
    const int row = static_cast<int>(std::lround(where.row_px)), col = static_cast<int>(std::lround(where.column_px));
    for (int r = std::max(0, row - reach); r <= std::min(rows - 1, row + reach); ++r) {
      for (int c = std::max(0, col - reach); c <= std::min(cols - 1, col + reach); ++c) {
        covered[static_cast<std::size_t>(r) * cols + c] = 1;
      }
    }
  }
  return covered;
}

void tint(ImageView<Rgb> picture, const std::vector<std::uint8_t>& covered, const Rgb& colour, bool dotted) {
  const auto inside = [&](int r, int c) {
    return picture.contains(r, c) && covered[static_cast<std::size_t>(r) * picture.cols + c] != 0;
  };
  for (int r = 0; r < picture.rows; ++r) {
    for (int c = 0; c < picture.cols; ++c) {
      if (!inside(r, c)) continue;
      const bool edge = !inside(r - 2, c) || !inside(r + 2, c) || !inside(r, c - 2) || !inside(r, c + 2);
      const bool drawn = edge && (!dotted || (r + c) % 8 < 4);
      picture(r, c) = mix(picture(r, c), colour, drawn ? 1.0 : 0.3);
    }
  }
}

// The values below which 1 % and 99 % of what is measured lie.
std::pair<float, float> middle_range(ImageView<const float> z_mm) {
  std::vector<float> sorted;
  for (int r = 0; r < z_mm.rows; ++r) {
    for (int c = 0; c < z_mm.cols; ++c) {
      if (z_mm(r, c) > 0.0F) sorted.push_back(z_mm(r, c));
    }
  }
  if (sorted.empty()) return {0.0F, 1.0F};
  const auto at = [&](double share) {
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), nth, sorted.end());
    return *nth;
  };
  const float low = at(0.01), high = at(0.99);
  return {low, std::max(high, low + 0.1F)};
}

}  // namespace

Rgb object_colour(unsigned number) {
  constexpr double kGoldenTurn = 0.618033988749895;  // successive hues never come close
  return rgb_from_hue(std::fmod(number * kGoldenTurn, 1.0), number % 2 == 0 ? 1.0 : 0.85);
}

Picture range_picture(ImageView<const float> z_mm) {
  Picture picture(z_mm.rows, z_mm.cols);
  const auto [low, high] = middle_range(z_mm);
  for (int r = 0; r < z_mm.rows; ++r) {
    for (int c = 0; c < z_mm.cols; ++c) {
      if (z_mm(r, c) <= 0.0F) continue;
      const double share = std::clamp((z_mm(r, c) - low) / (high - low), 0.0F, 1.0F);
      picture.view()(r, c) = rgb_from_hue(share * 2.0 / 3.0, 1.0);
    }
  }
  return picture;
}

Picture labels_picture(ImageView<const std::uint16_t> labels, ImageView<const std::uint8_t> texture) {
  Picture picture(labels.rows, labels.cols);
  for (int r = 0; r < labels.rows; ++r) {
    for (int c = 0; c < labels.cols; ++c) {
      const std::uint8_t shade = texture.empty() ? 128 : texture(r, c);
      picture.view()(r, c) = labels(r, c) == 0 ? grey(shade) : mix(grey(shade), object_colour(labels(r, c)), 0.6);
    }
  }
  return picture;
}

Picture overlay_picture(ImageView<const std::uint8_t> texture, std::span<const LocatedPart> parts,
                        std::span<const PartTemplate> templates, const Lens& camera) {
  Picture picture(texture.rows, texture.cols);
  for (int r = 0; r < texture.rows; ++r) {
    for (int c = 0; c < texture.cols; ++c) picture.view()(r, c) = grey(texture(r, c));
  }
  unsigned number = 0;
  for (const LocatedPart& part : parts) {
    const auto covered = silhouette(templates[static_cast<std::size_t>(part.template_index)], part.T_camera_part,
                                    camera, texture.rows, texture.cols);
    tint(picture.view(), covered, object_colour(++number), part.status == PoseStatus::kAmbiguous);
  }
  return picture;
}

}  // namespace beltpick::contract_io
