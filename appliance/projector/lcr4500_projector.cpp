#include "projector/lcr4500_projector.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "contract/result_codes.hpp"

namespace beltpick::projector {

namespace {

constexpr int kSwitch_ms = 3000;
constexpr int kValidate_ms = 5000;
constexpr int kOldestFirmware = 3;  // older ones validate differently

std::uint8_t low_byte(int value) { return static_cast<std::uint8_t>(value); }

Result<std::uint32_t> common_exposure_us(const Sequence& sequence) {
  const double first_us = sequence.frames.front().exposure_us;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const double exposure_us = sequence.frames[i].exposure_us;
    if (exposure_us == first_us) continue;
    return failure(
        ResultCode::kValueOutOfRange,
        "sequence frame %zu: expected the exposure of all others, %g us, found %g; the LightCrafter 4500 shows "
        "every pattern for the same time",
        i, first_us, exposure_us);
  }
  return static_cast<std::uint32_t>(std::lround(first_us));
}

std::uint32_t shortest_light_us(const Sequence& sequence) {
  const bool grey = std::any_of(sequence.frames.begin(), sequence.frames.end(),
                                [](const FrameSpec& frame) { return frame.kind == FrameKind::kPhase; });
  return lcr4500::kShortestExposure_us[grey ? lcr4500::kPhaseBits - 1 : 0];
}

}  // namespace

std::uint32_t Lcr4500Timing::delay_units() const {
  return static_cast<std::uint32_t>(std::lround(delay_us / kTriggerDelayUnit_us));
}

Result<Lcr4500Timing> plan_timing(const ShowPlan& plan) {
  const auto camera_us = common_exposure_us(plan.sequence);
  if (!camera_us) return std::unexpected(camera_us.error());
  const std::uint32_t least_us = shortest_light_us(plan.sequence) + 2 * kLead_us;
  if (*camera_us < least_us) {
    return failure(ResultCode::kValueOutOfRange,
                   "exposure_us: expected at least %u, what the LightCrafter 4500 needs to show the sequence's grey "
                   "levels, found %u; raise it in the recipe",
                   least_us, *camera_us);
  }
  Lcr4500Timing timing;
  timing.delay_us = plan.settle_us + kLead_us;
  timing.exposure_us = *camera_us - 2 * kLead_us;
  timing.period_us = timing.exposure_us + lcr4500::kBlackFill_us;
  const std::uint32_t needed_us = timing.delay_us + timing.period_us;
  if (plan.shortest_period_us < needed_us) {
    return failure(ResultCode::kValueOutOfRange,
                   "period_us: expected at least %u for the LightCrafter 4500, found %u; raise it in the recipe",
                   needed_us, plan.shortest_period_us);
  }
  return timing;
}

Result<void> Lcr4500Projector::prepare(const ShowPlan& plan) {
  const auto flash = lcr4500::plan_flash(plan.sequence);
  if (!flash) return std::unexpected(flash.error());
  const auto timing = plan_timing(plan);
  if (!timing) return std::unexpected(timing.error());
  running_ = false;
  load_us_ = static_cast<std::uint32_t>(std::min(flash->images, lcr4500::kPreloadedImages)) * lcr4500::kImageLoad_us;
  Result<void> done = open();
  if (done) done = look(*flash);
  if (done) done = set_mode();
  if (done) done = write_sequence(*flash, *timing);
  if (done) done = dlpc_->validate(kValidate_ms);
  if (done) tell_facts(version_, *flash);
  return done;
}

Result<void> Lcr4500Projector::open() {
  if (dlpc_) return {};
  const std::string path =
      config_.device.empty() ? find_hidraw(kVendorTexasInstruments, kProductDlpc350) : config_.device;
  facts_.device = path;
  if (path.empty()) {
    return failure(
        ResultCode::kProjectorLost,
        "projector: expected a LightCrafter 4500 on USB (%04x:%04x), found none; check its USB cable and power",
        kVendorTexasInstruments, kProductDlpc350);
  }
  auto channel = HidChannel::open(path);
  if (!channel) return std::unexpected(channel.error());
  dlpc_.emplace(std::move(*channel));
  return {};
}

// Whether it is a controller that we know, and has as many images as will be asked for.
Result<void> Lcr4500Projector::look(const lcr4500::FlashPlan& flash) {
  const auto version = dlpc_->version();
  if (!version) return std::unexpected(version.error());
  version_ = *version;
  if (version->major < kOldestFirmware) {
    return failure(ResultCode::kVersionUnsupported,
                   "projector: expected firmware %d.0.0 or newer, found %d.%d.%d; update it with the maker's program",
                   kOldestFirmware, version->major, version->minor, version->patch);
  }
  const auto images = dlpc_->read_byte(kImagesInFlash);
  if (!images && images.error().code == ResultCode::kProjectorRefused) return {};  // not every firmware tells
  if (!images) return std::unexpected(images.error());
  if (*images < config_.first_image + flash.images) {
    return failure(ResultCode::kProjectorRefused,
                   "projector: expected %d images in its flash from index %d, found %u images in all; write those of "
                   "`beltpick patterns --lcr4500` into it",
                   flash.images, config_.first_image, *images);
  }
  return {};
}

Result<void> Lcr4500Projector::set_mode() {
  Result<void> done = dlpc_->switch_to(kStartStop, kStop, kSwitch_ms);
  if (done) done = dlpc_->switch_to(kDisplayMode, kPatternDisplay, kSwitch_ms);
  if (done) done = dlpc_->switch_to(kPatternSource, kFromFlash, kSwitch_ms);
  return done;
}

Result<void> Lcr4500Projector::write_sequence(const lcr4500::FlashPlan& flash, const Lcr4500Timing& timing) {
  const auto patterns = static_cast<int>(flash.places.size());
  const std::array<std::uint8_t, 4> control{low_byte(patterns - 1), 1, low_byte(patterns - 1),
                                            low_byte(flash.images - 1)};
  std::array<std::uint8_t, 8> times{};
  std::ranges::copy(bytes_of(timing.exposure_us), times.begin());
  std::ranges::copy(bytes_of(timing.period_us), times.begin() + 4);
  Result<void> done = dlpc_->write(kTableControl, control);
  if (done) done = dlpc_->write(kTriggerMode, kTriggeredPatterns);
  if (done) done = dlpc_->write(kExposurePeriod, times);
  if (done) done = dlpc_->write(kTriggerIn1, bytes_of(timing.delay_units()));
  if (done) done = write_tables(flash);
  return done;
}

Result<void> Lcr4500Projector::write_tables(const lcr4500::FlashPlan& flash) {
  std::vector<std::uint8_t> images;
  for (int i = 0; i < flash.images; ++i) images.push_back(low_byte(config_.first_image + i));
  // Of exactly two images the maker's own programs send the second one first: so are the two buffers filled.
  if (images.size() == 2) std::swap(images[0], images[1]);

  std::vector<std::uint8_t> patterns;
  int image = -1;
  for (const FlashPlace& place : flash.places) {
    PatternEntry entry;
    entry.trigger = config_.rising_edge ? PatternTrigger::kRisingEdge : PatternTrigger::kFallingEdge;
    entry.number = low_byte(lcr4500::pattern_number(place));
    entry.depth = low_byte(place.bits);
    entry.leds = config_.leds;
    entry.black_after = true;  // the next one is triggered from outside
    entry.swap_buffer = place.image != image;
    image = place.image;
    std::ranges::copy(bytes_of(entry), std::back_inserter(patterns));
  }
  Result<void> done = dlpc_->write_table(TableOpen::kImages, images);
  if (done) done = dlpc_->write_table(TableOpen::kPatterns, patterns);
  return done;
}

void Lcr4500Projector::tell_facts(const FirmwareVersion& version, const lcr4500::FlashPlan& flash) {
  facts_.firmware =
      std::to_string(version.major) + "." + std::to_string(version.minor) + "." + std::to_string(version.patch);
  facts_.details = std::to_string(flash.places.size()) + " patterns in " + std::to_string(flash.planes) +
                   " bit planes of " + std::to_string(flash.images) + " images";
  if (flash.later_images() > 0) {
    facts_.details += ", " + std::to_string(flash.later_images()) + " of them loaded during a capture";
  }
}

Result<void> Lcr4500Projector::start() {
  if (!dlpc_) return failure(ResultCode::kProjectorLost, "projector: not open; it is looked for again by itself");
  // Stopped first: only then a start begins with the first pattern.
  Result<void> done = dlpc_->switch_to(kStartStop, kStop, kSwitch_ms);
  if (done) done = dlpc_->switch_to(kStartStop, kStart, kSwitch_ms);
  running_ = done.has_value();
  return done;
}

Result<void> Lcr4500Projector::stop() {
  running_ = false;
  return dlpc_ ? dlpc_->switch_to(kStartStop, kStop, kSwitch_ms) : Result<void>();
}

Result<void> Lcr4500Projector::check() {
  if (!dlpc_) return failure(ResultCode::kProjectorLost, "projector: not open; it is looked for again by itself");
  return dlpc_->check_status(running_);
}

Result<std::int64_t> Lcr4500Projector::show(int) {
  return failure(ResultCode::kInternal, "projector: expected one that is led by the PC, found one that an edge leads");
}

}  // namespace beltpick::projector
