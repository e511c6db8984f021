// A projector at a display connector (HDMI): all patterns are drawn into pages once, and each frame of a capture is a
// page flip that the display's own frame clock takes.
//
// No edge leads it, so the trigger follows: show() returns when the display has begun the page; capture/
// stepped_trigger.hpp then waits the projector's latency and starts the trigger for that one frame. Looser than an
// edge: a frame takes up to two frames of the display and the latency, some 60 ms at 60 Hz, where an edge takes 10.
#pragma once

#include "projector/drm_display.hpp"
#include "projector/projector.hpp"

namespace beltpick::projector {

struct DrmProjectorConfig {
  std::string device, connector;  // see DrmConfig
};

class DrmProjector : public Projector {
 public:
  explicit DrmProjector(const DrmProjectorConfig& config) : config_(config) {}

  Result<void> prepare(const ShowPlan& plan) override;
  Result<void> start() override;
  Result<void> stop() override;
  Result<void> check() override;
  void close() override { display_.close(); }
  [[nodiscard]] ProjectorFacts facts() const override;
  [[nodiscard]] bool leads() const override { return true; }
  Result<std::int64_t> show(int frame) override;

 private:
  [[nodiscard]] int dark_page() const { return display_.pages() - 1; }

  DrmProjectorConfig config_;
  DrmDisplay display_;
};

}  // namespace beltpick::projector
