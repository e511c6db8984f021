// beltpick segment: the objects of a capture or a cloud, as a label a pixel.
#include <algorithm>
#include <cstdlib>
#include <memory>

#include "commands.hpp"
#include "contract_io/npy_io.hpp"
#include "contract_io/pictures.hpp"
#include "number_stamp.hpp"
#include "options.hpp"
#include "segmented_input.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct SegmentCommand {
  SegmentChoices choices;
  std::string out, overlay;
};

Json json_of(const SegmentedInput& segmented) {
  Json segments = Json::array();
  for (const Segment& s : segmented.objects().segments) {
    segments.push_back({{"segment", s.label},
                        {"pixels", s.pixels},
                        {"rows", {s.row_min, s.row_max}},
                        {"columns", {s.col_min, s.col_max}},
                        {"top_mm", s.top_mm},
                        {"touches_border", s.touches_border}});
  }
  Json belt;
  if (const auto& plane = segmented.objects().belt) {
    belt = {{"normal", {plane->normal.x(), plane->normal.y(), plane->normal.z()}}, {"offset_mm", plane->offset_mm}};
  }
  return {{"capture", segmented.input().id()},
          {"belt", belt},
          {"segments", segments},
          {"left_out", segmented.objects().left_out},
          {"timing_ms", {{"segment", segmented.segment_ms()}}}};
}

std::string text_of(const SegmentedInput& segmented) {
  char line[160];
  std::snprintf(line, sizeof line, "%s: %zu objects%s\n", segmented.input().id().c_str(),
                segmented.objects().segments.size(),
                segmented.objects().belt ? "" : "; no plane carries the view, so all that was measured counts");
  std::string text = line;
  for (const Segment& s : segmented.objects().segments) {
    std::snprintf(line, sizeof line, "  %d: %d pixels, rows %d-%d, columns %d-%d, %.1f mm high%s\n", s.label, s.pixels,
                  s.row_min, s.row_max, s.col_min, s.col_max, static_cast<double>(s.top_mm),
                  s.touches_border ? ", cut by the image border" : "");
    text += line;
  }
  return text;
}

struct Pixel {
  int row = 0, col = 0;
};

// A pixel of the object near the middle of its box: an object with a hole or a bend does not hold the middle itself.
Pixel place_of_number(ImageView<const std::uint16_t> labels, const Segment& segment) {
  const Pixel middle{(segment.row_min + segment.row_max) / 2, (segment.col_min + segment.col_max) / 2};
  Pixel best = middle;
  int least = labels.rows + labels.cols;
  for (int row = segment.row_min; row <= segment.row_max; ++row) {
    for (int col = segment.col_min; col <= segment.col_max; ++col) {
      const int away = std::abs(row - middle.row) + std::abs(col - middle.col);
      if (labels(row, col) == segment.label && away < least) best = {row, col}, least = away;
    }
  }
  return best;
}

Result<void> write_overlay(const std::string& path, const SegmentedInput& segmented) {
  const auto& labels = segmented.objects().labels;
  auto picture = contract_io::labels_picture(labels, segmented.input().picture());
  const int scale = std::max(1, picture.cols / 320);
  for (const Segment& segment : segmented.objects().segments) {
    const Pixel at = place_of_number(labels, segment);
    stamp_number(picture, at.row, at.col, segment.label, scale);
  }
  return contract_io::write_png(path, std::as_const(picture).view());
}

Result<void> run(const SegmentCommand& command, Session& session) {
  const auto segmented = SegmentedInput::make(command.choices, session);
  if (!segmented) return std::unexpected(segmented.error());
  const auto& labels = (*segmented)->objects().labels;
  if (auto written =
          contract_io::write_npy<std::uint16_t>(command.out, {labels.data, labels.size()}, {labels.rows, labels.cols});
      !written) {
    return written;
  }
  if (!command.overlay.empty()) {
    if (auto written = write_overlay(command.overlay, **segmented); !written) return written;
  }
  session.answer(json_of(**segmented), text_of(**segmented));
  return {};
}

}  // namespace

Run add_segment(CLI::App& app) {
  const auto command = std::make_shared<SegmentCommand>();
  add_segment_choices(app, command->choices);
  app.add_option("--out", command->out, "write the number of each pixel's object, uint16, 0 for none")
      ->required()
      ->type_name("labels.npy");
  app.add_option("--overlay", command->overlay, "write a picture of the objects in colour, numbered")
      ->type_name("labels.png");
  example(app,
          "  beltpick segment capture --calibration calibration.json --out labels.npy --overlay labels.png\n"
          "  beltpick segment cloud.npy --out labels.npy");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
