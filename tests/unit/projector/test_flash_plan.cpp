#include <catch2/catch.hpp>

#include "contract/flash_plan.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"

using namespace beltpick;
using namespace beltpick::lcr4500;

namespace {

Sequence sequence_of(SequenceName name, SequenceAxes axes = SequenceAxes::kColumn) {
  return make_sequence(name, {kWidth, kHeight, ProjectorLayout::kDiamond}, axes).value();
}

}  // namespace

TEST_CASE("The fast sequence fits what is preloaded", "[flash_plan]") {
  const auto plan = plan_flash(sequence_of(SequenceName::kFast));
  REQUIRE(plan);
  CHECK(plan->planes == 5 * 8 + 7);
  CHECK(plan->images == 2);
  CHECK(plan->load_us() == 0);
  for (const std::uint32_t period_us : least_periods_us(*plan)) CHECK(period_us == 0);
  CHECK(plan->places[4] == FlashPlace{1, 8, 8});
  CHECK(pattern_number(plan->places[4]) == 1);
  CHECK(pattern_number(plan->places[11]) == 22);
}

TEST_CASE("An image that is followed by a further one is shown for as long as that one loads", "[flash_plan]") {
  const auto plan = plan_flash(sequence_of(SequenceName::kRobust));
  REQUIRE(plan);
  CHECK(plan->images == 6);
  CHECK(plan->load_us() == 800'000);
  const auto periods_us = least_periods_us(*plan);
  REQUIRE(periods_us.size() == plan->places.size());
  std::vector<double> shown_us(6, 0.0);
  for (std::size_t i = 0; i < periods_us.size(); ++i) {
    shown_us[static_cast<std::size_t>(plan->places[i].image)] += periods_us[i];
  }
  for (int image = 1; image < 5; ++image) CHECK(shown_us[static_cast<std::size_t>(image)] >= 200'000);
  CHECK(shown_us[0] == 0);  // while it is shown, the second is there already
  CHECK(shown_us[5] == 0);  // nothing comes after it
}

TEST_CASE("No place overlaps another, whatever the order of frames", "[flash_plan]") {
  Sequence sequence = sequence_of(SequenceName::kRobust, SequenceAxes::kBoth);
  std::reverse(sequence.frames.begin(), sequence.frames.end());
  const auto plan = plan_flash(sequence);
  REQUIRE(plan);
  std::vector<std::uint32_t> taken(static_cast<std::size_t>(plan->images), 0U);
  for (const FlashPlace& place : plan->places) {
    const std::uint32_t mask = ((1U << place.bits) - 1U) << place.first_plane;
    std::uint32_t& image = taken[static_cast<std::size_t>(place.image)];
    CHECK((image & mask) == 0);
    CHECK(mask < (1U << kPlanesPerImage));
    CHECK(place.first_plane % place.bits == 0);
    image |= mask;
  }
}

TEST_CASE("Places that a sequence tells are used, and refused where they cannot be shown", "[flash_plan]") {
  Sequence sequence = sequence_of(SequenceName::kFast);
  sequence.flash = plan_flash(sequence)->places;
  std::swap(sequence.flash[0], sequence.flash[2]);
  CHECK(plan_flash(sequence)->places == sequence.flash);
  const auto refused = [&](std::size_t frame, FlashPlace place) {
    Sequence other = sequence;
    other.flash[frame] = place;
    const auto plan = plan_flash(other);
    return !plan && plan.error().code == ResultCode::kValueOutOfRange;
  };
  CHECK(refused(0, {0, 0, 1}));   // a phase frame has 8 bits
  CHECK(refused(0, {0, 4, 8}));   // in one colour
  CHECK(refused(0, {1, 0, 8}));   // the first image comes first
  CHECK(refused(5, {3, 0, 1}));   // none is left out
  CHECK(refused(5, {1, 24, 1}));  // 24 planes
  sequence.flash.pop_back();
  CHECK_FALSE(plan_flash(sequence));
}

TEST_CASE("A sequence of another projector, or one too long, is refused with the reason", "[flash_plan]") {
  const auto other = make_sequence(SequenceName::kFast, {1280, 800}, SequenceAxes::kColumn);
  const auto plan = plan_flash(*other);
  REQUIRE_FALSE(plan);
  CHECK(plan.error().code == ResultCode::kFrameSizeMismatch);
  CHECK(plan.error().text().find("1280x800") != std::string_view::npos);
  Sequence longer = sequence_of(SequenceName::kRobust, SequenceAxes::kBoth);
  while (longer.frames.size() <= kMaxPatterns) longer.frames.push_back(longer.frames.back());
  CHECK(plan_flash(longer).error().code == ResultCode::kLimitExceeded);
  Sequence square = sequence_of(SequenceName::kFast);
  square.projector.layout = ProjectorLayout::kSquare;
  CHECK(plan_flash(square).error().text().find("on a square one") != std::string_view::npos);
  CHECK_FALSE(plan_flash(Sequence{square.projector, {}, {}}));
}
