#include "contract/flash_plan.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"

namespace beltpick::lcr4500 {

namespace {

int bits_of(const FrameSpec& frame) { return frame.kind == FrameKind::kPhase ? kPhaseBits : 1; }

Result<void> check(const Sequence& sequence) {
  const ProjectorGrid& grid = sequence.projector;
  const bool diamond = grid.layout == ProjectorLayout::kDiamond;
  if (grid.width != kWidth || grid.height != kHeight || !diamond) {
    return failure(
        ResultCode::kFrameSizeMismatch,
        "sequence: expected the LightCrafter 4500's %dx%d pixels on a diamond lattice, found %dx%d on a %s one; "
        "make the sequence with `beltpick patterns --lcr4500`",
        kWidth, kHeight, grid.width, grid.height, diamond ? "diamond" : "square");
  }
  if (sequence.frames.empty() || sequence.frames.size() > static_cast<std::size_t>(kMaxPatterns)) {
    return failure(ResultCode::kLimitExceeded,
                   "sequence: expected 1 to %d frames, what the LightCrafter 4500 holds, found %zu; use a shorter one",
                   kMaxPatterns, sequence.frames.size());
  }
  return {};
}

std::vector<FlashPlace> lay_out(const Sequence& sequence) {
  std::vector<FlashPlace> places;
  int image = 0;
  int next_plane = 0;
  for (const FrameSpec& frame : sequence.frames) {
    const int bits = bits_of(frame);
    next_plane = (next_plane + bits - 1) / bits * bits;
    if (next_plane + bits > kPlanesPerImage) {
      ++image;
      next_plane = 0;
    }
    places.push_back({image, next_plane, bits});
    next_plane += bits;
  }
  return places;
}

// Images can only be gone through one after the other.
Result<void> check_places(const Sequence& sequence) {
  int image = 0;
  for (std::size_t i = 0; i < sequence.flash.size(); ++i) {
    const FlashPlace& place = sequence.flash[i];
    const int bits = bits_of(sequence.frames[i]);
    const int next_image = i == 0 ? 0 : image + 1;
    if (place.bits != bits || place.first_plane < 0 || place.first_plane + bits > kPlanesPerImage ||
        place.first_plane % bits != 0 || (place.image != image && place.image != next_image)) {
      return failure(
          ResultCode::kValueOutOfRange,
          "sequence frame %zu: flash: expected %d bits within the 24 planes of image %d or %d, found %d bits "
          "from plane %d of image %d; make the sequence with `beltpick patterns --lcr4500`",
          i, bits, image, next_image, place.bits, place.first_plane, place.image);
    }
    image = place.image;
  }
  return {};
}

}  // namespace

int FlashPlan::frames_in(int image) const {
  return static_cast<int>(
      std::count_if(places.begin(), places.end(), [&](const FlashPlace& place) { return place.image == image; }));
}

Result<FlashPlan> plan_flash(const Sequence& sequence) {
  if (const auto good = check(sequence); !good) return std::unexpected(good.error());
  if (!sequence.flash.empty() && sequence.flash.size() != sequence.frames.size()) {
    return failure(ResultCode::kValueOutOfRange, "sequence: flash: expected the place of %zu frames, found %zu",
                   sequence.frames.size(), sequence.flash.size());
  }
  if (const auto good = check_places(sequence); !good) return std::unexpected(good.error());
  FlashPlan plan;
  plan.places = sequence.flash.empty() ? lay_out(sequence) : sequence.flash;
  for (const FlashPlace& place : plan.places) plan.planes += place.bits;
  plan.images = plan.places.back().image + 1;
  if (plan.images > kMaxImages) {
    return failure(ResultCode::kLimitExceeded,
                   "sequence: expected at most %d images of %d bit planes, found %d; use a shorter one", kMaxImages,
                   kPlanesPerImage, plan.images);
  }
  return plan;
}

std::string image_file(int image) { return "flash_" + std::to_string(image) + ".bmp"; }

std::vector<std::uint32_t> least_periods_us(const FlashPlan& plan) {
  std::vector<std::uint32_t> periods_us;
  for (const FlashPlace& place : plan.places) {
    const bool loads_meanwhile = place.image > 0 && place.image < plan.images - 1;
    const auto frames = static_cast<std::uint32_t>(plan.frames_in(place.image));
    periods_us.push_back(loads_meanwhile ? (kImageLoad_us + frames - 1) / frames : 0);
  }
  return periods_us;
}

}  // namespace beltpick::lcr4500
