// GigeCamera: one camera opened through Aravis, set up for line triggers, streaming into buffers of ours. Once it is
// lost it is only good to be destroyed. The only place that knows Aravis.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/result.hpp"
#include "capture/camera.hpp"
#include "capture/gvcp_probe.hpp"

typedef struct _ArvCamera ArvCamera;
typedef struct _ArvStream ArvStream;

namespace beltpick::capture {

class GigeCamera {
 public:
  // Opens, configures and starts the stream; blocks up to some seconds. `memory` holds config.buffers frames and
  // outlives the camera. kCameraNotFound, kFrameWrongSize (the sensor is smaller than configured), kCameraLost (it does
  // not take a setting).
  static Result<std::unique_ptr<GigeCamera>> open(const CameraConfig& config, std::span<std::uint8_t> memory);
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;

  std::optional<Frame> wait_frame(std::int64_t timeout_us);
  void requeue(const Frame& frame);
  [[nodiscard]] bool lost() const { return lost_; }
  void mark_lost() { lost_ = true; }
  // Leaves what Aravis holds of a silent camera to the end of the process: destroying it waits many seconds for
  // replies.
  void abandon();
  bool answers(int timeout_ms) { return probe_->answers(timeout_ms); }
  [[nodiscard]] const CameraFacts& facts() const { return facts_; }
  [[nodiscard]] unsigned generation() const { return generation_; }

 private:
  explicit GigeCamera(const CameraConfig& config);

  Result<void> connect();
  Result<void> identify();
  Result<void> configure();
  Result<void> configure_region();
  Result<void> configure_exposure();
  Result<void> start_stream(std::span<std::uint8_t> memory);
  void set_stream_options();

  CameraConfig config_;
  ArvCamera* camera_ = nullptr;
  ArvStream* stream_ = nullptr;
  unsigned long lost_signal_ = 0;
  std::optional<GvcpProbe> probe_;
  CameraFacts facts_;
  unsigned generation_ = 0;
  std::atomic<bool> lost_{false};
};

}  // namespace beltpick::capture
