// FrameGroup: which images belong to which exposures of a capture, so that a lost, an extra or a late one is known by
// its name. The camera counts its exposures in its frame ids, also those whose images are lost; the trigger numbers its
// pulses and tells when each was really exposed. What ties the one count to the other holds from capture to capture.
// Allocates nothing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/result.hpp"
#include "protocol/messages.hpp"

namespace beltpick::capture {

class FrameGroup {
 public:
  // An image that came while nothing was captured.
  void came_idle(std::uint64_t frame_id);

  // A capture of `wanted` frames follows; `triggers_before` pulses were given before it. kFrameExtra when the camera
  // exposed since the last capture without being triggered: told once.
  Result<void> begin(int wanted, std::uint32_t triggers_before, unsigned camera_generation);

  // The trigger told of an exposure, in its ticks.
  void exposed(const protocol::FrameEvent& event, unsigned tick_ns);

  // The frame of the sequence that this image is, in their order; nothing when it is a late one of an earlier capture.
  // kFrameMissing when the one before it was lost, kFrameExtra when no pulse asked for it.
  Result<std::optional<int>> place(std::uint64_t frame_id);

  // The same without taking it: a number of the sequence, below 0 of an earlier capture.
  [[nodiscard]] std::int64_t index_of(std::uint64_t frame_id) const;

  // Why the next frame is missing once no more can come: kFrameMissing.
  [[nodiscard]] Error missing() const;

  // Frames placed so far.
  [[nodiscard]] int frames() const { return frames_; }
  // Images of earlier captures that came during this one.
  [[nodiscard]] int late() const { return late_; }

  // The counts may have come apart: the next image is taken for the first frame.
  void untie() { tie_.reset(); }
  [[nodiscard]] bool tied() const { return tie_.has_value(); }

 private:
  struct Tie {
    std::uint64_t frame_id = 0;
    std::uint32_t trigger_number = 0;
    unsigned camera_generation = 0;
  };
  struct Exposure {
    bool told = false;
    double at_ms = 0.0;  // rise of its strobe, since the first frame began
    double length_ms = 0.0;
  };

  [[nodiscard]] std::int64_t trigger_number_of(std::uint64_t frame_id) const;
  [[nodiscard]] std::unexpected<Error> lost(std::uint64_t next_id, std::int64_t next_index) const;

  std::optional<Tie> tie_;
  std::int64_t idle_reach_ = 0;  // the highest trigger number that an image claimed while nothing was captured
  std::array<Exposure, protocol::kMaxFrames> exposures_{};
  int wanted_ = 0;
  int frames_ = 0;
  int late_ = 0;
  std::uint32_t triggers_before_ = 0;
  unsigned camera_generation_ = 0;
};

}  // namespace beltpick::capture
