// Captures as another's rig would take them, of a truth that is known: patterns straight from the format's words (not
// from the product's own generator), a slanted plane with a block on it, its shadow, texture and camera noise.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "contract_io/image_io.hpp"
#include "support/capture_files.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::test {

// One frame: its entry in capture.json, and the light at a projector coordinate (column, row), 0..1.
struct RigFrame {
  nlohmann::json entry;
  std::function<double(double, double)> light;
};
using RigFrames = std::vector<RigFrame>;

inline std::function<double(double, double)> along(const std::string& axis,
                                                   const std::function<double(double)>& light) {
  return [axis, light](double column, double row) { return light(axis == "column" ? column : row); };
}

inline RigFrame phase(const std::string& axis, double period_px, int steps, int step, double offset_rad = 0.0) {
  nlohmann::json entry{{"kind", "phase"}, {"axis", axis}, {"period_px", period_px}, {"steps", steps}, {"step", step}};
  if (offset_rad != 0.0) entry["offset_rad"] = offset_rad;
  const double shift_rad = offset_rad + 2.0 * std::numbers::pi * step / steps;
  return {entry, along(axis, [=](double x) {
            return 0.5 + 0.45 * std::cos(2.0 * std::numbers::pi * x / period_px + shift_rad);
          })};
}

inline RigFrame gray(const std::string& axis, double cell_px, int bit, bool inverted = false) {
  nlohmann::json entry{{"kind", "gray"}, {"axis", axis}, {"cell_px", cell_px}, {"bit", bit}, {"inverted", inverted}};
  return {entry, along(axis, [=](double x) {
            const auto cell = static_cast<unsigned>(std::max(0.0, std::floor((x + 0.5) / cell_px)));
            return (((cell ^ (cell >> 1U)) >> static_cast<unsigned>(bit)) & 1U) != (inverted ? 1U : 0U) ? 1.0 : 0.0;
          })};
}

inline RigFrame even(const std::string& kind) {
  return {{{"kind", kind}}, [level = kind == "white" ? 1.0 : 0.0](double, double) { return level; }};
}

inline void add(RigFrames& frames, const RigFrames& more) { frames.insert(frames.end(), more.begin(), more.end()); }

inline RigFrames phases(const std::string& axis, double period_px, int steps, double offset_rad = 0.0) {
  RigFrames frames;
  for (int step = 0; step < steps; ++step) frames.push_back(phase(axis, period_px, steps, step, offset_rad));
  return frames;
}

// Every bit that `extent_px` needs, from the highest down to `lowest`.
inline RigFrames grays(const std::string& axis, double cell_px, int extent_px, int lowest = 0, bool twins = false) {
  int highest = lowest;
  while (std::ldexp(cell_px, highest + 1) < extent_px) ++highest;
  RigFrames frames;
  for (int bit = highest; bit >= lowest; --bit) {
    frames.push_back(gray(axis, cell_px, bit));
    if (twins) frames.push_back(gray(axis, cell_px, bit, true));
  }
  return frames;
}

// The frames once more for each exposure; the scene's levels are those of 8 ms.
inline RigFrames exposed(const RigFrames& frames, const std::vector<double>& exposures_us) {
  RigFrames all;
  for (const double exposure_us : exposures_us) {
    for (RigFrame frame : frames) {
      frame.entry["exposure_us"] = exposure_us;
      all.push_back(frame);
    }
  }
  return all;
}

struct RigSize {
  int camera_width = 0, camera_height = 0;
  int projector_width = 0, projector_height = 0;
  double zoom = 0.9;    // projector pixels a camera pixel; below zero where the two see mirrored
  double gamma = 1.0;   // of the projector
  double gain = 150.0;  // level (of 255) of the mean texture under full light
  bool lone = false;    // the block alone on ground that is black
};

// What the camera sees: a projector coordinate, a gain and an ambient level (of 255) for each pixel.
struct RigScene {
  RigSize size;
  std::vector<double> column_px, row_px, gain, ambient;
  std::vector<bool> judged;  // lit, and not within a few pixels of an edge of block, shadow or projector
};

inline RigScene rig_scene(const RigSize& size) {
  RigScene scene{size, {}, {}, {}, {}, {}};
  constexpr int kBand = 4;
  const int shadow = std::max(3, size.camera_width / 12);
  for (int r = 0; r < size.camera_height; ++r) {
    for (int c = 0; c < size.camera_width; ++c) {
      const int left = size.camera_width * 2 / 5, right = size.camera_width * 3 / 4;
      const int top = size.camera_height * 3 / 10, bottom = size.camera_height * 7 / 10;
      const bool in_rows = r >= top && r < bottom;
      const bool block = in_rows && c >= left && c < right;
      const bool shaded = in_rows && c >= left - shadow && c < left;
      const double x =
          0.5 * size.projector_width + size.zoom * (c - 0.5 * size.camera_width) + 0.07 * r + (block ? 5.3 : 0);
      const double y = 0.5 * size.projector_height + size.zoom * (r - 0.5 * size.camera_height) + 0.03 * c;
      const bool aimed = x > -0.5 && y > -0.5 && x < size.projector_width - 0.5 && y < size.projector_height - 0.5;
      const bool inner = x > 3 && y > 3 && x < size.projector_width - 4 && y < size.projector_height - 4;
      const bool near_rows = r >= top - kBand && r < bottom + kBand;
      const auto near_column = [&](int edge) { return near_rows && std::abs(c - edge) <= kBand; };
      const bool near_row = (std::abs(r - top) <= kBand || std::abs(r - bottom) <= kBand) &&
                            c >= left - shadow - kBand && c < right + kBand;
      scene.column_px.push_back(x);
      scene.row_px.push_back(y);
      scene.gain.push_back(aimed && !shaded ? size.gain * (1.0 + 0.27 * std::sin(0.11 * c) * std::cos(0.07 * r)) *
                                                  (size.lone && !block ? 0.01 : 1.0)
                                            : 0.0);
      scene.ambient.push_back(6.0 + 2.0 * std::sin(0.02 * (r + c)));
      scene.judged.push_back(inner && (block || !size.lone) && !shaded && !near_row && !near_column(left) &&
                             !near_column(right) && !near_column(left - shadow));
    }
  }
  return scene;
}

// Levels of 255 of one frame: the light blurred by the lens, with shot and read noise.
inline std::vector<double> rig_levels(const RigScene& scene, const RigFrame& frame, Random& random) {
  std::vector<double> levels;
  for (std::size_t i = 0; i < scene.gain.size(); ++i) {
    double light = 0.0;
    if (scene.gain[i] > 0.0) {
      for (const double blur_px : {-0.6, -0.2, 0.2, 0.6})
        light +=
            0.25 * std::pow(frame.light(scene.column_px[i] + blur_px, scene.row_px[i] + blur_px), scene.size.gamma);
    }
    const double exposure = frame.entry.value("exposure_us", 8000.0) / 8000.0;
    const double level = exposure * (scene.gain[i] * light + scene.ambient[i]);
    double normal = -6.0;
    for (int n = 0; n < 12; ++n) normal += random.uniform();
    levels.push_back(level + normal * std::sqrt(level * 255.0 / 10'000.0 + 0.3));
  }
  return levels;
}

// Bytes of an image file of `levels` (of 255).
using RigEncode = std::function<std::string(const std::vector<double>& levels, int rows, int cols)>;

template <class Pixel>
std::vector<Pixel> quantised(const std::vector<double>& levels, int full_scale) {
  std::vector<Pixel> pixels;
  for (const double level : levels)
    pixels.push_back(static_cast<Pixel>(std::clamp(std::round(level * full_scale / 255.0), 0.0, 1.0 * full_scale)));
  return pixels;
}

inline std::string png8(const std::vector<double>& levels, int rows, int cols) {
  const auto pixels = quantised<std::uint8_t>(levels, 255);
  return contract_io::encode_png(ImageView<const std::uint8_t>(pixels.data(), rows, cols));
}

inline RigEncode png16(int full_scale) {
  return [full_scale](const std::vector<double>& levels, int rows, int cols) {
    const auto pixels = quantised<std::uint16_t>(levels, full_scale);
    return contract_io::encode_png(ImageView<const std::uint16_t>(pixels.data(), rows, cols));
  };
}

// As a colour camera sees a warm white: no channel is the grey level, their weighted mean is.
inline std::vector<contract_io::Rgb> warm(const std::vector<double>& levels) {
  constexpr double kRed = 1.15, kBlue = 0.7, kGreen = (1.0 - 0.299 * kRed - 0.114 * kBlue) / 0.587;
  const auto channel = [](double level) {
    return static_cast<std::uint8_t>(std::clamp(std::round(level), 0.0, 255.0));
  };
  std::vector<contract_io::Rgb> pixels;
  for (const double level : levels)
    pixels.push_back({channel(kRed * level), channel(kGreen * level), channel(kBlue * level)});
  return pixels;
}

inline std::string colour_png_of(const std::vector<double>& levels, int rows, int cols) {
  const auto pixels = warm(levels);
  return contract_io::encode_png(ImageView<const contract_io::Rgb>(pixels.data(), rows, cols));
}

// BMP rows run bottom-up and are padded to four bytes.
inline std::string bmp8(const std::vector<double>& levels, int rows, int cols) {
  const auto pixels = quantised<std::uint8_t>(levels, 255);
  std::string palette, bytes;
  for (std::uint64_t i = 0; i < 256; ++i) palette += little(i * 0x010101U, 4);
  for (int r = rows - 1; r >= 0; --r) {
    for (int c = 0; c < cols; ++c) bytes += static_cast<char>(pixels[static_cast<std::size_t>(r * cols + c)]);
    bytes.append(static_cast<std::size_t>(-cols & 3), '\0');
  }
  return bmp(cols, rows, 8, palette, bytes);
}

inline std::string bmp24(const std::vector<double>& levels, int rows, int cols) {
  const auto pixels = warm(levels);
  std::string bytes;
  for (int r = rows - 1; r >= 0; --r) {
    for (int c = 0; c < cols; ++c) {
      const auto& rgb = pixels[static_cast<std::size_t>(r * cols + c)];
      for (const int channel : {2, 1, 0}) bytes += static_cast<char>(rgb[static_cast<std::size_t>(channel)]);
    }
    bytes.append(static_cast<std::size_t>(-3 * cols & 3), '\0');
  }
  return bmp(cols, rows, 24, "", bytes);
}

// Writes frames and capture.json to the folder; `members` are laid over the file's own.
inline void write_rig_capture(const TempFolder& folder, const RigScene& scene, const RigFrames& frames,
                              const RigEncode& encode, const nlohmann::json& members) {
  const RigSize& size = scene.size;
  nlohmann::json capture{{"format", "beltpick-capture"},
                         {"version", 1},
                         {"projector", {{"width", size.projector_width}, {"height", size.projector_height}}},
                         {"frames", nlohmann::json::array()}};
  Random random(17);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string file = "shot " + std::to_string(i) + ".img";
    (void)folder.file(file, encode(rig_levels(scene, frames[i], random), size.camera_height, size.camera_width));
    capture["frames"].push_back(frames[i].entry);
    capture["frames"].back()["file"] = file;
  }
  capture.update(members);
  (void)folder.file("capture.json", capture.dump());
}

}  // namespace beltpick::test
