// beltpick decode: a capture to projector coordinates, and with a calibration to a cloud.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/cloud_io.hpp"
#include "contract_io/npy_io.hpp"
#include "measured_capture.hpp"
#include "options.hpp"
#include "quality_pictures.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct DecodeOptions {
  std::string capture, code, calibration, out, xyz, range, quality;
};

// Median of the values that `keep` accepts; 0 without any.
template <class Keep>
double median_of(ImageView<float> image, Keep keep) {
  std::vector<float> values;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (keep(i)) values.push_back(image.data[i]);
  }
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Result<void> write_code(const std::string& path, const CodeImage& code) {
  std::vector<float> values;
  values.reserve(2 * code.state.size());
  for (std::size_t i = 0; i < code.state.size(); ++i) {
    const bool valid = code.state.data[i] == PixelState::kValid;
    values.push_back(!valid || code.column_px.empty() ? NAN : code.column_px.data[i]);
    values.push_back(!valid || code.row_px.empty() ? NAN : code.row_px.data[i]);
  }
  return contract_io::write_npy<float>(path, values, {code.state.rows, code.state.cols, 2});
}

Result<void> write_outputs(const DecodeOptions& options, const MeasuredCapture& measured) {
  if (!options.code.empty()) {
    if (auto written = write_code(options.code, measured.code()); !written) return written;
  }
  if (!options.out.empty()) {
    if (auto written = contract_io::write_cloud_ply(options.out, measured.range()); !written) return written;
  }
  if (!options.xyz.empty()) {
    if (auto written = contract_io::write_cloud_npy(options.xyz, measured.range()); !written) return written;
  }
  if (!options.range.empty()) {
    if (auto written = contract_io::write_range_png(options.range, measured.range()); !written) return written;
  }
  return {};
}

Json describe_code(const MeasuredCapture& measured, const PixelCounts& states) {
  const CodeImage& code = measured.code();
  Json pixels = Json::object();
  for (std::size_t s = 0; s < states.size(); ++s) pixels[std::string(kPixelStateNames[s])] = states[s];
  Json axes = Json::array();
  if (!code.column_px.empty()) axes.push_back("column");
  if (!code.row_px.empty()) axes.push_back("row");
  const double modulation =
      median_of(code.modulation, [&](std::size_t i) { return code.state.data[i] == PixelState::kValid; });
  return {{"capture", measured.header().id},
          {"width", code.state.cols},
          {"height", code.state.rows},
          {"frames", measured.header().sequence.frames.size()},
          {"axes", axes},
          {"pixels", pixels},
          {"coverage", static_cast<double>(states[0]) / static_cast<double>(code.state.size())},
          {"median_modulation", modulation},
          {"timing_ms",
           {{"fold", measured.timing().fold_ms},
            {"decode", measured.timing().decode_ms},
            {"range", measured.timing().range_ms}}},
          {"memory", {{"bytes", measured.memory_bytes()}}}};
}

void describe_range(const MeasuredCapture& measured, Json& answer) {
  const RangeImage& range = measured.range();
  const auto measured_at = [&](std::size_t i) { return range.point_mm.data[i].z() > 0.0F; };
  answer["points"] = measured.counts().points;
  answer["median_sigma_mm"] = median_of(range.sigma_mm, measured_at);
  answer["rejected"] = {{"outside_projector", measured.counts().outside_projector},
                        {"axes_disagree", measured.counts().axes_disagree},
                        {"flying", measured.counts().flying}};
}

std::string describe(const MeasuredCapture& measured, const PixelCounts& states, const Json& answer) {
  char line[200];
  const double all = static_cast<double>(measured.code().state.size());
  std::snprintf(line, sizeof line, "%s: %d of %.0f pixels decoded (%.1f %%)", measured.header().id.c_str(), states[0],
                all, 100.0 * states[0] / all);
  std::string text = line;
  for (std::size_t s = 1; s < states.size(); ++s) {
    if (states[s] == 0) continue;
    std::snprintf(line, sizeof line, ", %.1f %% %s", 100.0 * states[s] / all, kPixelStateNames[s].data());
    text += line;
  }
  text += "\n";
  if (!measured.range().point_mm.empty()) {
    std::snprintf(line, sizeof line,
                  "%d points, predicted noise %.3f mm (median along the ray), %d flying pixels dropped\n",
                  measured.counts().points, answer["median_sigma_mm"].get<double>(), measured.counts().flying);
    text += line;
  }
  return text;
}

// Twelve bits in images of sixteen are dark all over where capture.json does not tell so.
std::unexpected<Error> nothing_measured(const std::string& capture, const PixelCounts& states, int full_scale) {
  const bool dark = 2 * states[1] > std::accumulate(states.begin(), states.end(), 0);
  char scale[120] = "";
  if (dark && full_scale > 255) {
    std::snprintf(scale, sizeof scale, ", and that the camera's white is full_scale %d (12 bits: 4095)", full_scale);
  }
  return failure(ResultCode::kTooFewPoints,
                 "%s: no pixel was measured (%d dark, %d saturated, %d without fringe, %d of uncertain order); check "
                 "exposure, focus and calibration%s",
                 capture.c_str(), states[1], states[2], states[3], states[4], scale);
}

Result<void> check_options(const DecodeOptions& options) {
  const bool cloud = !options.out.empty() || !options.xyz.empty() || !options.range.empty();
  if (cloud && options.calibration.empty()) {
    return failure(ResultCode::kUsage, "--out, --xyz and --range need --calibration: points come from the geometry");
  }
  return {};
}

Result<void> run(const DecodeOptions& options, Session& session) {
  if (auto checked = check_options(options); !checked) return checked;
  contract_io::Warnings warnings;
  std::optional<Calibration> calibration;
  if (!options.calibration.empty()) {
    auto read = contract_io::read_calibration(options.calibration, warnings);
    if (!read) return std::unexpected(read.error());
    calibration = std::move(*read);
  }
  const auto measured = MeasuredCapture::make(options.capture, calibration, warnings, session.json);
  session.warn(warnings);
  if (!measured) return std::unexpected(measured.error());
  const auto states = count_pixels((*measured)->code().state);
  Json answer = describe_code(**measured, states);
  if (calibration) describe_range(**measured, answer);
  // Most wanted where nothing else comes out.
  if (!options.quality.empty()) {
    if (auto written = write_quality(options.quality, **measured); !written) return written;
  }
  if (states[0] == 0 || (calibration && (*measured)->counts().points == 0)) {
    return nothing_measured(options.capture, states, (*measured)->header().full_scale);
  }
  if (auto written = write_outputs(options, **measured); !written) return written;
  session.answer(answer, describe(**measured, states, answer));
  return {};
}

}  // namespace

Run add_decode(CLI::App& app) {
  const auto options = std::make_shared<DecodeOptions>();
  app.add_option("CAPTURE", options->capture, "folder or .zip with capture.json and its frames")->required();
  app.add_option("--code", options->code, "write projector column and row of every pixel")->type_name("code.npy");
  app.add_option("--calibration", options->calibration, "of this camera and projector")->type_name("calibration.json");
  app.add_option("--out", options->out, "write the valid points")->type_name("cloud.ply");
  app.add_option("--xyz", options->xyz, "write the organised cloud in mm")->type_name("cloud.npy");
  app.add_option("--range", options->range, "write camera z as a 16-bit image, 0.02 mm a count")
      ->type_name("range.png");
  app.add_option("--quality", options->quality,
                 "write pictures of what is measured how well, and why not: states, modulation, predicted noise, order")
      ->type_name("DIR");
  example(app,
          "  beltpick decode capture --code code.npy\n"
          "  beltpick decode capture --calibration calibration.json --out cloud.ply --range range.png\n"
          "  beltpick decode capture --quality quality");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
