// Projector: whatever shows the patterns, one after the other. The drivers: edge_projector.hpp (shows by itself,
// advances on an edge), lcr4500_projector.hpp (LightCrafter 4500: set up over USB, advances on an edge),
// drm_projector.hpp (a display: each page is flipped by this PC).
//
// One thread at a time may call; projector_keeper.hpp has that thread. start() and show() allocate nothing.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.hpp"
#include "contract/capture.hpp"

namespace beltpick::projector {

// What is to be shown, and the camera's timing that it has to fit. Made with the recipe.
struct ShowPlan {
  Sequence sequence;                     // with the exposure of every frame
  std::uint32_t settle_us = 0;           // from the advance edge to the camera's exposure
  std::uint32_t shortest_period_us = 0;  // of all frames: from an advance edge to the next
};

// For the self-test and the log.
struct ProjectorFacts {
  std::string name;      // "LightCrafter 4500", "display HDMI-A-1"
  std::string device;    // "/dev/hidraw0"
  std::string firmware;  // "4.0.0"; empty where there is none
  std::string details;   // "47 of 47 planes preloaded", "1920x1080 at 60.0 Hz"
};

class Projector {
 public:
  virtual ~Projector() = default;

  // Opens the device, where that is not done, and gives it the whole sequence. Blocks for some seconds at worst.
  // Errors: kProjectorLost, kProjectorSilent, kProjectorRefused, kProjectorWrongReply, kProjectorFault; kLimitExceeded,
  // kFrameSizeMismatch and kValueOutOfRange for a sequence or timing that it cannot show.
  virtual Result<void> prepare(const ShowPlan& plan) = 0;

  // From here the next advance shows the first pattern, in `ready_in_us` at the latest.
  virtual Result<void> start() = 0;
  [[nodiscard]] virtual std::uint32_t ready_in_us() const { return 0; }

  // Ends the showing: dark.
  virtual Result<void> stop() = 0;

  // Asks the device how it is, between captures. The error says what is wrong: kProjectorFault with the device's own
  // words, or that it is lost.
  virtual Result<void> check() = 0;

  // Closes the device: prepare() opens it again.
  virtual void close() = 0;

  // What was found at the last prepare(); names the device that is looked for where none was.
  [[nodiscard]] virtual ProjectorFacts facts() const = 0;

  // True where no edge advances it: then show() has to, frame by frame, and the trigger follows it.
  [[nodiscard]] virtual bool leads() const { return false; }
  // Shows a frame of the sequence and returns when it is on the display: monotonic time in us. Where leads().
  virtual Result<std::int64_t> show(int frame) = 0;
};

}  // namespace beltpick::projector
