#include "app/projector_choice.hpp"

#include <cmath>

#include "contract/flash_plan.hpp"
#include "projector/drm_projector.hpp"
#include "projector/edge_projector.hpp"
#include "projector/lcr4500_projector.hpp"

namespace beltpick::app {

namespace {

using projector::kLedBlue, projector::kLedGreen, projector::kLedRed;

// A display begins a page with its next frame and shows it with the one after that; and the trigger is armed anew.
constexpr double kDisplayFrames_us = 2 * 17'000;
constexpr double kStepOverhead_us = 20'000;

std::uint8_t leds_of(const std::string& light) {
  if (light == "red") return kLedRed;
  if (light == "green") return kLedGreen;
  if (light == "blue") return kLedBlue;
  if (light == "yellow") return kLedRed | kLedGreen;
  if (light == "magenta") return kLedRed | kLedBlue;
  if (light == "cyan") return kLedGreen | kLedBlue;
  return kLedRed | kLedGreen | kLedBlue;
}

}  // namespace

std::unique_ptr<projector::Projector> make_projector(const Settings& settings) {
  if (settings.projector_kind == kLcr4500Projector) {
    projector::Lcr4500Config config;
    config.device = settings.projector_device;
    config.first_image = settings.projector_first_image;
    config.rising_edge = settings.projector_edge == "rising";
    config.leds = leds_of(settings.projector_light);
    return std::make_unique<projector::Lcr4500Projector>(config);
  }
  if (settings.projector_kind == kDisplayProjector) {
    return std::make_unique<projector::DrmProjector>(
        projector::DrmProjectorConfig{settings.projector_device, settings.projector_connector});
  }
  return std::make_unique<projector::EdgeProjector>();
}

ProjectorLayout projector_layout(const Settings& settings) {
  const bool diamond = settings.projector_layout == "diamond" || settings.projector_kind == kLcr4500Projector;
  return diamond ? ProjectorLayout::kDiamond : ProjectorLayout::kSquare;
}

Result<std::vector<std::uint32_t>> projector_periods_us(const Settings& settings, const Sequence& sequence,
                                                        double settle_us) {
  std::vector<std::uint32_t> periods_us;
  if (settings.projector_kind == kLcr4500Projector) {
    const auto flash = lcr4500::plan_flash(sequence);
    if (!flash) return std::unexpected(flash.error());
    periods_us = lcr4500::least_periods_us(*flash);
  }
  if (settings.projector_kind == kDisplayProjector) {
    for (const FrameSpec& frame : sequence.frames) {
      const double least_us =
          kDisplayFrames_us + kStepOverhead_us + settings.projector_latency_us + settle_us + frame.exposure_us;
      periods_us.push_back(static_cast<std::uint32_t>(std::lround(least_us)));
    }
  }
  return periods_us;
}

Result<void> check_projector_timing(const Settings& settings, const projector::ShowPlan& plan) {
  if (settings.projector_kind != kLcr4500Projector) return {};
  const auto timing = projector::plan_timing(plan);
  return timing ? Result<void>() : std::unexpected(timing.error());
}

}  // namespace beltpick::app
