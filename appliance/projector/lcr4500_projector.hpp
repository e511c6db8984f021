// The LightCrafter 4500 in pattern sequence mode: images from its flash (as `beltpick patterns --lcr4500` composes
// them), each pattern shown by an edge on TRIG_IN_1.
//
// An 8-bit pattern is made of light pulses of different length, spread over its exposure: a camera that sees a part of
// it sees wrong grey levels. So the pattern is shown within the camera's exposure: the controller delays it behind the
// edge by the settle time and kLead_us, and shows it for the camera's exposure less kLead_us at both ends.
//
//   advance edge   _|‾|______________________________________|‾|__
//   camera pulse   ________|‾‾‾‾‾‾‾‾ exposure ‾‾‾‾‾‾‾|____________
//                   settle
//   pattern        __________|‾‾‾‾‾‾ light ‾‾‾‾‾‾‾‾|_______________
//                         lead                   lead
#pragma once

#include <optional>
#include <string>

#include "contract/flash_plan.hpp"
#include "projector/dlpc350.hpp"
#include "projector/projector.hpp"

namespace beltpick::projector {

inline constexpr std::uint32_t kLead_us = 100;

struct Lcr4500Config {
  std::string device{};     // of hidraw; empty: found by its USB ids
  int first_image = 0;      // index in the flash of the plan's first image
  bool rising_edge = true;  // that advances
  std::uint8_t leds = kLedRed | kLedGreen | kLedBlue;
};

// The times that the controller is given.
struct Lcr4500Timing {
  std::uint32_t delay_us = 0;     // from the edge to the pattern
  std::uint32_t exposure_us = 0;  // of the pattern
  std::uint32_t period_us = 0;    // exposure and the black fill behind it

  // The controller's count of the delay.
  [[nodiscard]] std::uint32_t delay_units() const;
};

// Errors: kValueOutOfRange where the frames' exposures differ, where a pattern would be shown too shortly for its bits,
// or where it does not fit the period: with what the recipe needs instead.
Result<Lcr4500Timing> plan_timing(const ShowPlan& plan);

class Lcr4500Projector : public Projector {
 public:
  explicit Lcr4500Projector(const Lcr4500Config& config) : config_(config) {}
  // For tests: talks through this channel instead of opening one.
  Lcr4500Projector(const Lcr4500Config& config, HidChannel channel)
      : config_(config), dlpc_(std::in_place, std::move(channel)) {}

  Result<void> prepare(const ShowPlan& plan) override;
  Result<void> start() override;
  [[nodiscard]] std::uint32_t ready_in_us() const override { return load_us_; }
  Result<void> stop() override;
  Result<void> check() override;
  void close() override { dlpc_.reset(); }
  [[nodiscard]] ProjectorFacts facts() const override { return facts_; }
  Result<std::int64_t> show(int frame) override;

 private:
  Result<void> open();
  Result<void> look(const lcr4500::FlashPlan& flash);
  Result<void> set_mode();
  Result<void> write_sequence(const lcr4500::FlashPlan& flash, const Lcr4500Timing& timing);
  Result<void> write_tables(const lcr4500::FlashPlan& flash);
  void tell_facts(const FirmwareVersion& version, const lcr4500::FlashPlan& flash);

  Lcr4500Config config_;
  std::optional<Dlpc350> dlpc_;
  FirmwareVersion version_;
  std::uint32_t load_us_ = 0;
  bool running_ = false;
  ProjectorFacts facts_{"LightCrafter 4500", "", "", ""};
};

}  // namespace beltpick::projector
