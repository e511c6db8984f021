#include "app/recorder.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>

#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/pictures.hpp"
#include "contract_io/result_io.hpp"

namespace beltpick::app {

namespace {

// 20260131T123456_00042
std::string folder_name(std::uint16_t capture) {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm broken{};
  gmtime_r(&now, &broken);
  char text[64];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%S", &broken);
  char name[80];
  std::snprintf(name, sizeof name, "%s_%05u", text, capture);
  return name;
}

}  // namespace

Recorder::Recorder(Arena& arena, const Settings& settings, Log& log) : settings_(settings), log_(log) {
  if (settings.record_folder.empty()) return;
  const Limits& limits = settings.limits;
  const auto pixels = static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height);
  if (settings.record_frames != "none") {
    frames_ = arena.take<std::uint8_t>("record frames", pixels * static_cast<std::size_t>(limits.frames));
  }
  z_mm_ = arena.take_image<float>("record pictures", limits.image_height, limits.image_width);
  texture_ = arena.take_image<std::uint8_t>("record pictures", limits.image_height, limits.image_width);
  labels_ = arena.take_image<std::uint16_t>("record pictures", limits.image_height, limits.image_width);
  parts_ = arena.take<LocatedPart>("record pictures", static_cast<std::size_t>(limits.parts));
  withheld_ = arena.take<WithheldObject>("record pictures", static_cast<std::size_t>(limits.segments + limits.parts));
}

void Recorder::begin() {
  if (settings_.record_folder.empty() || state_ == State::kWriting) return;
  state_ = State::kFilling;
  frame_count_ = 0;
  part_count_ = withheld_count_ = 0;
  failure_ = ResultCode::kOk;
}

ImageView<const std::uint8_t> Recorder::frame(int index) const {
  const std::size_t pixels = texture_.size();
  return {frames_.data() + static_cast<std::size_t>(index) * pixels, texture_.rows, texture_.cols};
}

void Recorder::keep_frame(int index, ImageView<const std::uint8_t> image) {
  if (state_ != State::kFilling || !keeps_frames() || index >= settings_.limits.frames) return;
  if (image.rows != texture_.rows || image.cols != texture_.cols) return;
  std::uint8_t* to = frames_.data() + static_cast<std::size_t>(index) * texture_.size();
  for (int row = 0; row < image.rows; ++row) std::memcpy(to + row * image.cols, image.row(row), image.cols);
  frame_count_ = std::max(frame_count_, index + 1);
}

void Recorder::keep_result(const CaptureRecord& record) {
  if (state_ != State::kFilling) return;
  record_ = record;
  for (int row = 0; row < z_mm_.rows; ++row) {
    for (int col = 0; col < z_mm_.cols; ++col) z_mm_(row, col) = record.range.point_mm(row, col).z();
    std::memcpy(texture_.row(row), record.range.texture.row(row), static_cast<std::size_t>(texture_.cols));
    std::memcpy(labels_.row(row), record.labels.row(row),
                static_cast<std::size_t>(labels_.cols) * sizeof(std::uint16_t));
  }
  part_count_ = std::min(record.parts.size(), parts_.size());
  std::copy_n(record.parts.begin(), part_count_, parts_.begin());
  withheld_count_ = std::min(record.withheld.size(), withheld_.size());
  std::copy_n(record.withheld.begin(), withheld_count_, withheld_.begin());
  state_ = State::kWriting;
}

void Recorder::keep_failure(std::uint16_t capture, ResultCode code) {
  if (state_ != State::kFilling) return;
  record_ = {};
  record_.capture = capture;
  failure_ = code;
  state_ = keeps_frames() ? State::kWriting : State::kFree;
}

void Recorder::serve(const ModelHub& hub, std::span<const Arena::Share> budget) {
  if (state_ != State::kWriting) return;
  const auto folder = make_folder();
  const auto written = folder ? write_all(hub, budget, *folder) : Result<void>(std::unexpected(folder.error()));
  if (!written)
    log_.write(LogLevel::kWarning, "capture %u was not recorded: %s", record_.capture, written.error().detail);
  ::malloc_trim(0);  // pictures are large
  state_ = State::kFree;
}

Result<std::filesystem::path> Recorder::make_folder() {
  while (written_.size() >= static_cast<std::size_t>(settings_.record_keep)) {
    std::error_code ignored;  // somebody else may have taken it away
    std::filesystem::remove_all(written_.front(), ignored);
    written_.pop_front();
  }
  const auto folder = from_settings(settings_, settings_.record_folder) / folder_name(record_.capture);
  if (const auto made = contract_io::make_folder(folder); !made) return std::unexpected(made.error());
  written_.push_back(folder);
  return folder;
}

Result<void> Recorder::write_all(const ModelHub& hub, std::span<const Arena::Share> budget,
                                 const std::filesystem::path& folder) {
  const bool failed = failure_ != ResultCode::kOk;
  if (keeps_frames() && (failed || settings_.record_frames == "all" ||
                         (settings_.record_frames == "withheld" && withholds_something()))) {
    if (const auto frames = write_frames(hub, folder); !frames) return frames;
  }
  if (failed) return contract_io::write_file(folder / "failure.txt", std::string(result_code_name(failure_)) + "\n");
  if (const auto result = write_result(hub, budget, folder); !result) return result;
  return settings_.record_pictures ? write_pictures(hub, folder) : Result<void>{};
}

bool Recorder::withholds_something() const {
  return withheld_count_ > 0 || std::any_of(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(part_count_),
                                            [](const LocatedPart& part) { return part.grasp_index < 0; });
}

Result<void> Recorder::write_frames(const ModelHub& hub, const std::filesystem::path& folder) const {
  CaptureHeader header;
  header.sequence = hub.recipe().sequence;
  header.id = folder.filename().string();
  const int frames = std::min(frame_count_, static_cast<int>(header.sequence.frames.size()));
  for (int i = 0; i < frames; ++i) {
    const auto written =
        contract_io::write_png(folder / header.sequence.frames[static_cast<std::size_t>(i)].file, frame(i));
    if (!written) return written;
  }
  return contract_io::write_capture(folder / "capture.json", header);
}

Result<void> Recorder::write_result(const ModelHub& hub, std::span<const Arena::Share> budget,
                                    const std::filesystem::path& folder) const {
  LocateReport report;
  report.capture_id = folder.filename().string();
  report.calibration_id = hub.geometry().calibration.id;
  report.parts.assign(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(part_count_));
  report.withheld.assign(withheld_.begin(), withheld_.begin() + static_cast<std::ptrdiff_t>(withheld_count_));
  report.stage_times = {
      {Stage::kDecode, record_.decode_ms}, {Stage::kRange, record_.range_ms}, {Stage::kSegment, record_.segment_ms}};
  const double part_ms = part_count_ == 0 ? 0.0 : record_.locate_ms / static_cast<double>(part_count_);
  for (const LocatedPart& part : report.parts) report.part_times.push_back({part.segment, part_ms});
  for (const Arena::Share& share : budget) report.memory.push_back({share.name, share.bytes});
  return contract_io::write_result(folder / "result.json", report, hub.recipe().templates, hub.geometry().cell);
}

Result<void> Recorder::write_pictures(const ModelHub& hub, const std::filesystem::path& folder) const {
  const auto range = contract_io::range_picture(z_mm_);
  if (const auto written = contract_io::write_png(folder / "range_colour.png", range.view()); !written) return written;
  const auto objects = contract_io::labels_picture(labels_, texture_);
  if (const auto written = contract_io::write_png(folder / "objects.png", objects.view()); !written) return written;
  const auto overlay = contract_io::overlay_picture(texture_, parts_.first(part_count_), hub.recipe().templates,
                                                    hub.geometry().calibration.camera);
  return contract_io::write_png(folder / "overlay.png", overlay.view());
}

}  // namespace beltpick::app
