// What a sequence must have to be decodable, and that the refusal says what lacks.
#include <catch2/catch.hpp>
#include <string>

#include "contract/result_codes.hpp"
#include "decode/plan.hpp"
#include "unit/decode/synthetic.hpp"

namespace beltpick::testing {
namespace {

constexpr Axis kC = Axis::kColumn;

Sequence empty_sequence() {
  Sequence sequence;
  sequence.projector = {912, 1140};
  return sequence;
}

void check_refused(const Sequence& sequence, const std::string& names) {
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE_FALSE(plan);
  CHECK(plan.error().code == ResultCode::kSequenceUndecodable);
  INFO(plan.error().detail);
  CHECK(std::string(plan.error().text()).find(names) != std::string::npos);
}

TEST_CASE("sequences that do not determine the coordinate are refused with the reason") {
  Sequence s = empty_sequence();
  check_refused(s, "no frames");
  s.frames = {plain_frame(FrameKind::kWhite), plain_frame(FrameKind::kBlack)};
  check_refused(s, "none of the 2 frames");

  s = empty_sequence();
  add_phases(s, kC, 18, 8);
  check_refused(s, "fringe order is not determined");

  s = empty_sequence();
  add_phases(s, kC, 18, 8);
  add_gray(s, kC, 36);
  check_refused(s, "fringe order is not determined");

  s = empty_sequence();
  add_gray(s, kC, 8);
  check_refused(s, "no threshold");

  s = empty_sequence();
  add_phases(s, kC, 18, 8);
  add_gray(s, kC, 9);
  s.frames.erase(s.frames.begin() + 10);  // bit 4
  check_refused(s, "bit 4");

  s = empty_sequence();
  add_phases(s, kC, 18, 4);
  s.frames.erase(s.frames.begin() + 1, s.frames.begin() + 3);
  add_gray(s, kC, 9);
  check_refused(s, "at least three distinct shifts");

  s = empty_sequence();
  add_phases(s, kC, 18, 8);
  add_gray(s, kC, 9);
  s.frames.insert(s.frames.begin() + 10, s.frames[3]);
  check_refused(s, "same pattern");
}

TEST_CASE("the last frame may show an earlier pattern once more") {
  Sequence s = empty_sequence();
  add_phases(s, kC, 18, 8);
  add_gray(s, kC, 9);
  const auto once = decode::make_fold_plan(s);
  s.frames.push_back(s.frames[3]);
  const auto twice = decode::make_fold_plan(s);
  REQUIRE(once);
  REQUIRE(twice);
  CHECK(twice->repeated.first == 3);
  CHECK(twice->repeated.last == static_cast<int>(s.frames.size()) - 1);
  CHECK(twice->state_bytes(1) == once->state_bytes(1) + 1);
}

TEST_CASE("raw frames are kept only where their threshold comes later") {
  Sequence s = empty_sequence();
  add_gray(s, kC, 4, 0, true);
  auto plan = decode::make_fold_plan(s);
  REQUIRE(plan);
  CHECK(plan->state_bytes(1) == (8 * 2 + 7) / 8 + 1 + 2);  // eight bits that may be weak, one waiting frame, extremes

  s = empty_sequence();
  add_phases(s, kC, 18, 8);
  add_gray(s, kC, 9);
  plan = decode::make_fold_plan(s);
  REQUIRE(plan);
  // Two sums and their mean, flags, seven bits that may be weak; three frames that wait to be added together, in whose
  // memory the threshold lies later.
  CHECK(plan->state_bytes(1) == 4 + 2 + 1 + 2 + 3);
}

TEST_CASE("unequal steps are solved by least squares, without more noise than they must have") {
  Sequence s = empty_sequence();
  add_phases(s, kC, 18, 8);
  s.frames.erase(s.frames.begin() + 2);
  add_gray(s, kC, 9);
  const auto plan = decode::make_fold_plan(s);
  REQUIRE(plan);
  CHECK(plan->channels.front().noise_gain > 0.5);
  CHECK(plan->channels.front().noise_gain < 0.7);
}

}  // namespace
}  // namespace beltpick::testing
