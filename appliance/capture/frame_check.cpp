#include "capture/frame_check.hpp"

#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {

constexpr int kBoxPixels = FrameCheck::kBox * FrameCheck::kBox;

// A sample that changes by less than this over the sequence, in grey levels, sees no pattern.
constexpr int kLeastRange = 6 * kBoxPixels;
// Share of such samples below which a picture shows no pattern at all.
constexpr float kLeastPatterned = 0.01F;
// A striped or white frame with fewer bright samples stayed black; a wide pattern has to fall this far below the last
// good one.
constexpr float kBlackShare = 0.05F;
constexpr float kBlackFall = 0.1F;
// Neighbouring phase steps differ by at least 0.4 of the fringe's amplitude up to 16 steps; noise of box means stays
// below 0.1.
constexpr float kSameSpread = 0.25F;
// White and black, or two Gray bits in a narrow view, may differ by their mean only; ambient light flickers by less
// than this.
constexpr float kSameShift = 0.5F;

std::uint16_t box_sum(const ImageView<const std::uint8_t>& image, int row, int col) {
  int sum = 0;
  for (int r = row; r < row + FrameCheck::kBox; ++r) {
    const std::uint8_t* pixels = image.row(r) + col;
    for (int c = 0; c < FrameCheck::kBox; ++c) sum += pixels[c];
  }
  return static_cast<std::uint16_t>(sum);
}

// Start of box `index` of `count` that are spread evenly over `pixels`.
int box_start(int index, int count, int pixels) { return (2 * index + 1) * (pixels - FrameCheck::kBox) / (2 * count); }

}  // namespace

FrameCheck::FrameCheck(int max_frames, Arena& arena) : max_frames_(max_frames) {
  const auto frames = static_cast<std::size_t>(max_frames);
  samples_ = arena.take<std::uint16_t>("frame check", frames * kSamples);
  low_ = arena.take<std::uint16_t>("frame check", kSamples);
  high_ = arena.take<std::uint16_t>("frame check", kSamples);
  looks_ = arena.take<Look>("frame check", frames);
  good_ = arena.take<Look>("frame check", frames);
  sorted_ = arena.take<float>("frame check", frames);
}

void FrameCheck::add(ImageView<const std::uint8_t> image) {
  if (frames_ == max_frames_) return;
  std::uint16_t* sample = samples_.data() + static_cast<std::size_t>(frames_) * kSamples;
  for (int r = 0; r < kGridRows; ++r) {
    const int row = box_start(r, kGridRows, image.rows);
    for (int c = 0; c < kGridCols; ++c) *sample++ = box_sum(image, row, box_start(c, kGridCols, image.cols));
  }
  ++frames_;
}

Result<void> FrameCheck::judge(std::span<const FrameExpectation> expected) {
  expected = expected.first(std::min(expected.size(), static_cast<std::size_t>(frames_)));
  const bool nothing_to_see = std::ranges::all_of(expected, [](const FrameExpectation& e) { return e.dark; });
  if (!look(expected) && !nothing_to_see && expected.size() > 1) {
    return failure(
        ResultCode::kFrameBlack,
        "capture: expected stripes, found no pattern in any of %zu frames; check the projector and the lens cap",
        expected.size());
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (stayed_black(i, expected[i])) {
      return failure(ResultCode::kFrameBlack,
                     "frame %zu of %zu: expected a pattern, found it black; check the projector and its advance line",
                     i, expected.size());
    }
  }
  for (std::size_t i = 1; i < expected.size(); ++i) {
    if (identical(static_cast<int>(i))) {
      return failure(ResultCode::kFrameDuplicated,
                     "frame %zu of %zu: expected the next picture, found the one before once more; check camera and "
                     "network",
                     i, expected.size());
    }
    if (must_differ(i, expected) && same_as_before(looks_[i])) {
      return failure(
          ResultCode::kPatternRepeated,
          "frame %zu of %zu: expected the next pattern, found that of the frame before; check the projector's "
          "advance line",
          i, expected.size());
    }
  }
  std::ranges::copy(looks_, good_.begin());
  good_frames_ = expected.size();
  return {};
}

bool FrameCheck::stayed_black(std::size_t frame, const FrameExpectation& expected) const {
  if (expected.dark) return false;
  const float share = looks_[frame].share;
  if (expected.stripes || expected.bright) return share < kBlackShare;
  return frame < good_frames_ && good_[frame].share > kBlackShare && share < kBlackFall * good_[frame].share;
}

// Narrow stripes differ in any view; of wide ones the last good capture tells.
bool FrameCheck::must_differ(std::size_t frame, std::span<const FrameExpectation> expected) const {
  const FrameExpectation& now = expected[frame];
  const FrameExpectation& before = expected[frame - 1];
  if (!looks_[frame].comparable) return false;
  if (now.stripes || before.stripes || (now.bright && before.dark) || (now.dark && before.bright)) return true;
  return frame < good_frames_ && !same_as_before(good_[frame]);
}

bool FrameCheck::same_as_before(const Look& look) {
  return look.spread < kSameSpread * look.usual && std::abs(look.shift) < kSameShift * look.range;
}

// Fills looks_, exposure by exposure: a dimmer repeat of the sequence is judged by itself. False when none shows a
// pattern.
bool FrameCheck::look(std::span<const FrameExpectation> expected) {
  bool patterned = false;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto earlier = expected.first(i);
    const auto same = [&](const FrameExpectation& e) { return e.exposure_us == expected[i].exposure_us; };
    if (std::ranges::none_of(earlier, same)) patterned |= look_at_exposure(expected, expected[i].exposure_us);
  }
  return patterned;
}

// False when hardly any sample saw a pattern; nothing is said of such frames.
bool FrameCheck::look_at_exposure(std::span<const FrameExpectation> expected, double exposure_us) {
  find_range(expected, exposure_us);
  int patterned_samples = 0;
  double range = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    patterned_samples += high_[i] - low_[i] >= kLeastRange ? 1 : 0;
    range += high_[i] - low_[i];
  }
  const bool patterned = static_cast<float>(patterned_samples) >= kLeastPatterned * kSamples;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].exposure_us != exposure_us) continue;
    Look& look = looks_[i];
    look = Look();
    look.share = patterned ? bright_share(static_cast<int>(i)) : 1.0F;
    look.range = static_cast<float>(range / kSamples);
    look.comparable = patterned && i > 0 && !expected[i].repeats && expected[i - 1].exposure_us == exposure_us;
    if (look.comparable) measure_change(static_cast<int>(i), look);
  }
  const float usual = usual_spread(expected, exposure_us);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].exposure_us == exposure_us) looks_[i].usual = usual;
  }
  return patterned;
}

// Darkest and brightest value of each sample over the frames of one exposure.
void FrameCheck::find_range(std::span<const FrameExpectation> expected, double exposure_us) {
  std::ranges::fill(low_, std::uint16_t{0xFFFF});
  std::ranges::fill(high_, std::uint16_t{0});
  for (std::size_t frame = 0; frame < expected.size(); ++frame) {
    if (expected[frame].exposure_us != exposure_us) continue;
    const auto values = samples(static_cast<int>(frame));
    for (std::size_t i = 0; i < kSamples; ++i) {
      low_[i] = std::min(low_[i], values[i]);
      high_[i] = std::max(high_[i], values[i]);
    }
  }
}

float FrameCheck::bright_share(int frame) const {
  const auto values = samples(frame);
  int patterned = 0;
  int bright = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const int range = high_[i] - low_[i];
    if (range < kLeastRange) continue;
    ++patterned;
    bright += 2 * (values[i] - low_[i]) > range ? 1 : 0;
  }
  return static_cast<float>(bright) / static_cast<float>(std::max(patterned, 1));
}

void FrameCheck::measure_change(int frame, Look& look) const {
  const auto now = samples(frame);
  const auto before = samples(frame - 1);
  double sum = 0.0;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double change = static_cast<double>(now[i]) - static_cast<double>(before[i]);
    sum += change;
    square_sum += change * change;
  }
  const double mean = sum / kSamples;
  look.shift = static_cast<float>(mean);
  look.spread = static_cast<float>(std::sqrt(std::max(square_sum / kSamples - mean * mean, 0.0)));
}

float FrameCheck::usual_spread(std::span<const FrameExpectation> expected, double exposure_us) {
  std::size_t phases = 0;
  std::size_t others = sorted_.size();
  for (std::size_t i = 1; i < expected.size(); ++i) {
    if (!looks_[i].comparable || expected[i].exposure_us != exposure_us) continue;
    // Phase steps from the front, others from the back.
    const bool both = expected[i].phase && expected[i - 1].phase;
    sorted_[both ? phases++ : --others] = looks_[i].spread;
  }
  const std::span<float> usual = phases >= 3 ? sorted_.first(phases) : sorted_.subspan(others);
  if (usual.empty()) return 0.0F;
  const auto middle = usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2);
  std::nth_element(usual.begin(), middle, usual.end());
  return *middle;
}

// The same numbers to the last bit, and not only because both are black or saturated: noise makes that impossible.
bool FrameCheck::identical(int frame) const {
  const auto now = samples(frame);
  const auto [low, high] = std::ranges::minmax_element(now);
  return *low != *high && std::ranges::equal(now, samples(frame - 1));
}

}  // namespace beltpick::capture
