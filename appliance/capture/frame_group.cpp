#include "capture/frame_group.hpp"

#include <algorithm>

#include "capture/frame_ids.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

std::int64_t FrameGroup::trigger_number_of(std::uint64_t frame_id) const {
  return tie_->trigger_number + frames_between(tie_->frame_id, frame_id);
}

std::int64_t FrameGroup::index_of(std::uint64_t frame_id) const {
  return tie_ ? trigger_number_of(frame_id) - triggers_before_ - 1 : 0;
}

void FrameGroup::came_idle(std::uint64_t frame_id) {
  if (tie_) idle_reach_ = std::max(idle_reach_, trigger_number_of(frame_id));
}

Result<void> FrameGroup::begin(int wanted, std::uint32_t triggers_before, unsigned camera_generation) {
  // Camera or firmware began to count anew.
  if (tie_ && (tie_->camera_generation != camera_generation || triggers_before < tie_->trigger_number)) tie_.reset();
  const std::int64_t extra = tie_ ? idle_reach_ - triggers_before : 0;
  wanted_ = wanted;
  frames_ = late_ = 0;
  idle_reach_ = 0;
  triggers_before_ = triggers_before;
  camera_generation_ = camera_generation;
  exposures_.fill({});
  if (extra <= 0) return {};
  tie_.reset();
  return failure(ResultCode::kFrameExtra,
                 "before the capture: expected no exposure since trigger %u, found %lld that no pulse asked for; check "
                 "the trigger line for noise, and that nothing else triggers the camera",
                 triggers_before, static_cast<long long>(extra));
}

void FrameGroup::exposed(const protocol::FrameEvent& event, unsigned tick_ns) {
  if (event.frame >= wanted_) return;
  const double ms_per_tick = tick_ns * 1e-6;
  exposures_[event.frame] = {true, event.strobe_ticks * ms_per_tick, event.strobe_length_ticks * ms_per_tick};
}

Result<std::optional<int>> FrameGroup::place(std::uint64_t frame_id) {
  if (!tie_) tie_ = {frame_id, triggers_before_ + 1, camera_generation_};
  const std::int64_t index = index_of(frame_id);
  if (index < frames_) {
    ++late_;
    return std::optional<int>();
  }
  if (frames_ == wanted_ || index >= wanted_) {
    return failure(
        ResultCode::kFrameExtra,
        "expected %d frames, found one more (id %llu, exposure %lld of the sequence); check the trigger line "
        "for noise, and that nothing else triggers the camera",
        wanted_, static_cast<unsigned long long>(frame_id), static_cast<long long>(index + 1));
  }
  if (index > frames_) return lost(frame_id, index);
  tie_ = {frame_id, triggers_before_ + 1 + static_cast<std::uint32_t>(index), camera_generation_};
  return std::optional<int>(frames_++);
}

std::unexpected<Error> FrameGroup::lost(std::uint64_t next_id, std::int64_t next_index) const {
  return failure(ResultCode::kFrameMissing, "%.220s; the next one (id %llu) is frame %lld", missing().detail,
                 static_cast<unsigned long long>(next_id), static_cast<long long>(next_index));
}

Error FrameGroup::missing() const {
  const int frame = std::min(frames_, wanted_ - 1);
  const Exposure& exposure = exposures_[static_cast<std::size_t>(std::max(frame, 0))];
  const std::uint32_t trigger = triggers_before_ + 1 + static_cast<std::uint32_t>(frame);
  if (exposure.told) {
    return failure(ResultCode::kFrameMissing,
                   "frame %d of %d (trigger %u): exposed at %.2f ms for %.2f ms, but its image was lost; check the "
                   "network and its receive buffers",
                   frame, wanted_, trigger, exposure.at_ms, exposure.length_ms)
        .error();
  }
  return failure(ResultCode::kFrameMissing,
                 "frame %d of %d (trigger %u): lost, and its exposure was not told; check the trigger and strobe lines",
                 frame, wanted_, trigger)
      .error();
}

}  // namespace beltpick::capture
