// Recorder: keeps a capture, its result and pictures of both. The vision thread copies into memory taken at start; the
// service thread writes files from it. While one capture is being written the next one waits.
#pragma once

#include <atomic>
#include <deque>
#include <filesystem>
#include <span>

#include "app/log.hpp"
#include "app/model_hub.hpp"
#include "app/settings.hpp"
#include "base/arena.hpp"
#include "base/stages.hpp"
#include "contract/locate_result.hpp"

namespace beltpick::app {

// What the vision thread hands over when a capture's locating has ended.
struct CaptureRecord {
  std::uint16_t capture = 0;
  RangeImage range;
  ImageView<const std::uint16_t> labels;
  std::span<const LocatedPart> parts;
  std::span<const WithheldObject> withheld;
  double decode_ms = 0.0, range_ms = 0.0, segment_ms = 0.0, locate_ms = 0.0;
};

class Recorder {
 public:
  Recorder(Arena& arena, const Settings& settings, Log& log);

  // The vision thread's side; none of it blocks or allocates.
  [[nodiscard]] bool idle() const { return state_ != State::kWriting; }
  void begin();
  void keep_frame(int index, ImageView<const std::uint8_t> image);
  void keep_result(const CaptureRecord& record);
  void keep_failure(std::uint16_t capture, ResultCode code);

  // The service thread's: writes what waits. `budget` goes into result.json.
  void serve(const ModelHub& hub, std::span<const Arena::Share> budget);

 private:
  enum class State : std::uint8_t { kFree, kFilling, kWriting };

  [[nodiscard]] bool withholds_something() const;
  [[nodiscard]] bool keeps_frames() const { return !frames_.empty(); }
  [[nodiscard]] ImageView<const std::uint8_t> frame(int index) const;
  Result<std::filesystem::path> make_folder();
  Result<void> write_all(const ModelHub& hub, std::span<const Arena::Share> budget,
                         const std::filesystem::path& folder);
  Result<void> write_frames(const ModelHub& hub, const std::filesystem::path& folder) const;
  Result<void> write_result(const ModelHub& hub, std::span<const Arena::Share> budget,
                            const std::filesystem::path& folder) const;
  Result<void> write_pictures(const ModelHub& hub, const std::filesystem::path& folder) const;

  const Settings& settings_;
  Log& log_;
  std::atomic<State> state_{State::kFree};
  std::span<std::uint8_t> frames_;
  int frame_count_ = 0;
  ImageView<float> z_mm_;
  ImageView<std::uint8_t> texture_;
  ImageView<std::uint16_t> labels_;
  std::span<LocatedPart> parts_;
  std::span<WithheldObject> withheld_;
  std::size_t part_count_ = 0, withheld_count_ = 0;
  CaptureRecord record_;  // its views are not used
  ResultCode failure_ = ResultCode::kOk;
  std::deque<std::filesystem::path> written_;
};

}  // namespace beltpick::app
