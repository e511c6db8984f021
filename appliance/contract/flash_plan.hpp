// How a sequence lies in the flash of a LightCrafter 4500: which 24-bit image holds each frame, in which of its bit
// planes. `beltpick patterns --lcr4500` composes the images by it and writes it into sequence.json; the appliance's
// driver addresses them by it.
//
// Facts of the controller (DLPC350), by the headings of Texas Instruments' "DLPC350 Programmer's Guide" (DLPU010) and
// "DLP LightCrafter 4500 User's Guide" (DLPU011):
//   - A flash image has 24 bit planes: G0..G7, R0..R7, B0..B7, counted in this order (guide, "Pattern Number Mapping").
//   - Two images, 48 planes, are held in memory; a further one is loaded into the buffer that is not shown, which takes
//     up to 200 ms (user's guide, "Pattern Sequence Background").
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/capture.hpp"

namespace beltpick::lcr4500 {

inline constexpr int kWidth = 912, kHeight = 1140;  // on a diamond lattice
inline constexpr int kPlanesPerImage = 24;
inline constexpr int kPreloadedImages = 2;
inline constexpr std::uint32_t kImageLoad_us = 200'000;  // of one image, at the longest
inline constexpr int kMaxPatterns = 128;                 // of one sequence: entries of the pattern table
inline constexpr int kMaxImages = 64;                    // of one sequence: entries of the image table
inline constexpr int kPhaseBits = 8;                     // bit planes of a phase frame; all others take one

// The shortest time that a pattern of 1 to 8 bits can be shown (user's guide, "Pattern exposure").
inline constexpr std::array<std::uint32_t, 8> kShortestExposure_us{235, 700, 1570, 1700, 2000, 2500, 4500, 8333};
// What the controller needs between two patterns for the black fill (guide, "Exposure and Frame Period").
inline constexpr std::uint32_t kBlackFill_us = 230;

// As the pattern table of the controller counts: among the patterns of this depth in one image.
[[nodiscard]] constexpr int pattern_number(const FlashPlace& place) { return place.first_plane / place.bits; }

struct FlashPlan {
  std::vector<FlashPlace> places;  // one a frame, in projection order
  int images = 0;
  int planes = 0;  // that are used

  // Images beyond those that are preloaded, and the time their loading may take.
  [[nodiscard]] int later_images() const { return images > kPreloadedImages ? images - kPreloadedImages : 0; }
  [[nodiscard]] std::uint32_t load_us() const { return static_cast<std::uint32_t>(later_images()) * kImageLoad_us; }
  [[nodiscard]] int frames_in(int image) const;
};

// Where the frames lie: as the sequence tells, else laid into images in projection order, each whole in one image: an
// 8-bit pattern into one colour, a 1-bit pattern into the next plane. Errors: kFrameSizeMismatch where the projector is
// not 912x1140; kLimitExceeded where the sequence has more frames or images than the controller's tables;
// kValueOutOfRange where the places it tells cannot be shown.
Result<FlashPlan> plan_flash(const Sequence& sequence);

// The file of an image, beside sequence.json: flash_0.bmp, ...
std::string image_file(int image);

// The shortest time from one advance to the next that each frame allows, so that every image is loaded when it is
// needed: while an image between the first and the last is shown, the one after it is being loaded. 0 where the frame
// does not matter. The same for all frames of an image: few groups for the trigger box, and no longer in all.
std::vector<std::uint32_t> least_periods_us(const FlashPlan& plan);

}  // namespace beltpick::lcr4500
