// What the vision thread does, without its thread: one capture, and the locating of what it saw. The real one is
// CaptureAndLocate; tests stand in for it.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "base/result.hpp"
#include "contract/locate_result.hpp"

namespace beltpick::app {

struct Located {
  std::span<const LocatedPart> parts;  // in pick order; valid until the next capture
  std::span<const WithheldObject> withheld;
};

class VisionWork {
 public:
  virtual ~VisionWork() = default;

  // Makes capture `number`; blocks until its last frame is folded. `cancel` other than kOk ends it soon with that code.
  virtual Result<void> capture(std::uint16_t number, const std::atomic<ResultCode>& cancel) = 0;
  // Locates the parts in what was captured last.
  virtual Result<Located> locate(std::uint16_t number) = 0;

  // False while what was captured last is still being written to disk: no capture may start. Any thread.
  [[nodiscard]] virtual bool idle() const { return true; }
  // Why a capture could not be made at this moment. Any thread; neither blocks nor allocates.
  [[nodiscard]] virtual ResultCode device_code() const = 0;
};

}  // namespace beltpick::app
