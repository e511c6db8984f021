#include "quality_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/json_writer.hpp"
#include "contract_io/pictures.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Picture;
using contract_io::Rgb;

struct StateLook {
  Rgb colour;
  const char* colour_name;
  const char* meaning;
};

// In the order of PixelState.
constexpr std::array<StateLook, kPixelStateNames.size()> kLooks{
    {{{255, 255, 255}, "grey, as bright as the scene", "measured"},
     {{16, 24, 72}, "dark blue", "too little of the projector's light: shadow, or a dark surface; expose longer"},
     {{235, 40, 40}, "red", "a fringe frame is saturated; expose shorter, or at several exposures"},
     {{40, 110, 235}, "blue", "light, but hardly a fringe: out of focus, glancing, or lit by something else"},
     {{235, 60, 220}, "magenta", "the fringe's order is uncertain, or frames or geometry contradict it"},
     {{250, 200, 30}, "yellow", "at a depth edge: mixes two depths, or half covered"},
     {{40, 200, 90}, "green", "moved while it was captured"}}};

Picture states_picture(const CodeImage& code) {
  Picture picture(code.state.rows, code.state.cols);
  for (std::size_t i = 0; i < code.state.size(); ++i) {
    const PixelState state = code.state.data[i];
    const std::uint8_t shade = code.texture.data[i];
    picture.pixels[i] =
        state == PixelState::kValid ? Rgb{shade, shade, shade} : kLooks[static_cast<std::size_t>(state)].colour;
  }
  return picture;
}

bool valid_at(const CodeImage& code, std::size_t i) { return code.state.data[i] == PixelState::kValid; }

// The value that all but a hundredth of the valid pixels stay below; at least `least`.
float upper_end(const CodeImage& code, const std::vector<float>& values, float least) {
  std::vector<float> sorted;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (valid_at(code, i)) sorted.push_back(values[i]);
  }
  if (sorted.empty()) return least;
  const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 99 / 100);
  std::nth_element(sorted.begin(), nth, sorted.end());
  return std::max(*nth, least);
}

// From green (0) over yellow (half) to red (`end` and more); black where not measured.
Picture noise_picture(const CodeImage& code, const std::vector<float>& sigma, float end) {
  Picture picture(code.state.rows, code.state.cols);
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    if (!valid_at(code, i)) continue;
    const float share = std::clamp(sigma[i] / end, 0.0F, 1.0F);
    const auto red = static_cast<std::uint8_t>(255.0F * std::min(2.0F * share, 1.0F));
    const auto green = static_cast<std::uint8_t>(220.0F * std::min(2.0F - 2.0F * share, 1.0F));
    picture.pixels[i] = {red, green, 0};
  }
  return picture;
}

std::vector<float> sigma_px(const CodeImage& code) {
  const CodeNoise& noise = code.column_px.empty() ? code.row_noise : code.column_noise;
  std::vector<float> sigma(code.state.size());
  for (std::size_t i = 0; i < sigma.size(); ++i)
    sigma[i] = noise.sigma_px(code.modulation.data[i], code.texture.data[i]);
  return sigma;
}

// Width of what a colour of order.png stands for: the finest fringe's period, else a Gray cell.
double order_width_px(const MeasuredCapture& measured) {
  const Axis axis = measured.code().column_px.empty() ? Axis::kRow : Axis::kColumn;
  const decode::FoldPlan& plan = measured.plan();
  const decode::AxisPlan& planned = plan.exposures.front().axes[static_cast<std::size_t>(axis)];
  if (planned.channels.empty()) return plan.grays[static_cast<std::size_t>(planned.gray)].cell_px;
  return plan.channels[static_cast<std::size_t>(planned.channels.front())].period_px;
}

Picture order_picture(const CodeImage& code, double width_px) {
  const ImageView<float>& code_px = code.column_px.empty() ? code.row_px : code.column_px;
  Picture picture(code.state.rows, code.state.cols);
  for (std::size_t i = 0; i < code_px.size(); ++i) {
    if (!valid_at(code, i)) continue;
    const double order = std::floor((static_cast<double>(code_px.data[i]) + 0.5) / width_px);
    picture.pixels[i] = contract_io::object_colour(static_cast<unsigned>(std::max(order, 0.0)) + 1U);
  }
  return picture;
}

// Collects what is written into the folder.
class QualityFolder {
 public:
  QualityFolder(std::filesystem::path folder, const CodeImage& code) : folder_(std::move(folder)), code_(code) {}

  Result<void> add_states() {
    legend_ += "states.png: why a pixel is measured or not\n";
    contract_io::Json counts = contract_io::Json::object();
    const PixelCounts states = count_pixels(code_.state);
    for (std::size_t s = 0; s < states.size(); ++s) {
      counts[std::string(kPixelStateNames[s])] = states[s];
      legend_ += "  " + std::string(kPixelStateNames[s]) + ": " + kLooks[s].colour_name + ": " + kLooks[s].meaning +
                 ": " + std::to_string(states[s]) + " pixels\n";
      json_["colours"][std::string(kPixelStateNames[s])] = kLooks[s].colour;
    }
    json_["pixels"] = counts;
    return contract_io::write_png(folder_ / "states.png", states_picture(code_).view());
  }

  Result<void> add_modulation() {
    const std::vector<float> values(code_.modulation.data, code_.modulation.data + code_.modulation.size());
    const float end = upper_end(code_, values, 1.0F);
    std::vector<std::uint8_t> grey(values.size());
    for (std::size_t i = 0; i < grey.size(); ++i) {
      grey[i] = static_cast<std::uint8_t>(255.0F * std::clamp(values[i] / end, 0.0F, 1.0F));
    }
    add_scale("modulation.png", "amplitude of the fringe in grey levels (of 255): black 0, white", end);
    return contract_io::write_png(folder_ / "modulation.png",
                                  ImageView<const std::uint8_t>(grey.data(), code_.state.rows, code_.state.cols));
  }

  Result<void> add_noise(const std::string& file, const char* meaning, const std::vector<float>& sigma) {
    const float end = upper_end(code_, sigma, 1e-4F);
    add_scale(file, meaning, end);
    return contract_io::write_png(folder_ / file, noise_picture(code_, sigma, end).view());
  }

  Result<void> add_order(double width_px) {
    add_scale("order.png", "every fringe or Gray cell in a colour of its own; their width in projector pixels",
              width_px);
    return contract_io::write_png(folder_ / "order.png", order_picture(code_, width_px).view());
  }

  Result<void> finish() {
    if (auto written = contract_io::write_file(folder_ / "legend.txt", legend_); !written) return written;
    return contract_io::write_file(folder_ / "quality.json", contract_io::json_text(json_));
  }

 private:
  void add_scale(const std::string& file, const std::string& meaning, double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    legend_ += file + ": " + meaning + " " + text + "\n";
    json_["scales"][file] = value;
  }

  std::filesystem::path folder_;
  const CodeImage& code_;
  std::string legend_;
  contract_io::Json json_ = {{"format", "beltpick-quality"}, {"version", 1}};
};

}  // namespace

Result<void> write_quality(const std::filesystem::path& folder, const MeasuredCapture& measured) {
  const CodeImage& code = measured.code();
  if (auto made = contract_io::make_folder(folder); !made) return made;
  QualityFolder to(folder, code);
  if (auto added = to.add_states(); !added) return added;
  if (auto added = to.add_modulation(); !added) return added;
  if (auto added = to.add_noise(
          "sigma_px.png", "predicted standard deviation of the code in projector pixels: green 0, red", sigma_px(code));
      !added) {
    return added;
  }
  if (const RangeImage& range = measured.range(); !range.point_mm.empty()) {
    const std::vector<float> sigma_mm(range.sigma_mm.data, range.sigma_mm.data + range.sigma_mm.size());
    auto added =
        to.add_noise("sigma_mm.png", "predicted standard deviation of the point in mm: green 0, red", sigma_mm);
    if (!added) return added;
  }
  if (auto added = to.add_order(order_width_px(measured)); !added) return added;
  return to.finish();
}

}  // namespace beltpick::cli
