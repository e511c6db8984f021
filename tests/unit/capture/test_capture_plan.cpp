#include <catch2/catch.hpp>

#include "capture/capture_plan.hpp"
#include "contract/result_codes.hpp"
#include "core/plan.hpp"
#include "patterns.hpp"

using namespace beltpick;
using capture::make_plan;

TEST_CASE("a sequence of one exposure is one group with the shortest period that holds it", "[plan]") {
  const auto plan = make_plan(patterns::standard(), {.exposure_us = 8000, .settle_us = 1000, .readout_us = 6000});
  REQUIRE(plan);
  REQUIRE(plan->timing.group_count == 1);
  CHECK(plan->timing.groups[0].frames == 17);
  CHECK(plan->timing.groups[0].period_us == 14000);
  CHECK(plan->duration_us == 17 * 14000);
  auto arm = plan->timing;
  arm.arm_id = 1;
  CHECK(core::judge(arm) == protocol::Refusal::kNone);
}

TEST_CASE("each change of exposure is a group, and the firmware takes every plan we make", "[plan]") {
  auto sequence = patterns::standard();
  for (int i = 0; i < 17; ++i)
    sequence.frames[static_cast<std::size_t>(i)].exposure_us = i < 10 ? 2000 : i < 12 ? 700 : 9000;
  const auto plan = make_plan(sequence, {});
  REQUIRE(plan);
  CHECK(plan->timing.group_count == 3);
  CHECK(plan->timing.groups[1].exposure_us == 700);
  CHECK(core::judge(plan->timing) == protocol::Refusal::kNone);
  for (std::size_t i = 0; i < 17; ++i) sequence.frames[i].exposure_us = 1000 + 100.0 * static_cast<double>(i);
  CHECK(make_plan(sequence, {}).error().code == ResultCode::kLimitExceeded);
}

TEST_CASE("timings that cannot be run are refused with the numbers", "[plan]") {
  const auto tight = make_plan(patterns::standard(), {.exposure_us = 8000, .readout_us = 6000, .period_us = 13999});
  REQUIRE_FALSE(tight);
  CHECK(tight.error().code == ResultCode::kValueOutOfRange);
  CHECK(tight.error().text().find("14000") != std::string_view::npos);
  CHECK(make_plan(patterns::standard(), {.exposure_us = 990000}).error().code == ResultCode::kValueOutOfRange);
  CHECK(make_plan(patterns::standard(), {.period_us = 1000001}).error().code == ResultCode::kValueOutOfRange);
  CHECK(make_plan(patterns::standard(), {.exposure_us = 0}).error().code == ResultCode::kValueOutOfRange);
  CHECK(make_plan(Sequence(), {}).error().code == ResultCode::kLimitExceeded);
}

TEST_CASE("a camera that overlaps exposure and readout gets the shorter period, and one it can follow", "[plan]") {
  const capture::CaptureTiming overlapping{.exposure_us = 8000, .readout_us = 12000, .overlap_gap_us = 50};
  const auto plain = make_plan(patterns::standard(), overlapping);
  REQUIRE(plain);
  CHECK(plain->timing.groups[0].period_us == 12000);
  CHECK(core::judge(plain->timing) == protocol::Refusal::kNone);

  auto hdr = patterns::standard();
  for (const double exposure_us : {9000.0, 700.0, 4000.0}) {
    hdr.frames.insert(hdr.frames.end(), 3, patterns::frame(FrameKind::kWhite));
    for (std::size_t i = hdr.frames.size() - 3; i < hdr.frames.size(); ++i) hdr.frames[i].exposure_us = exposure_us;
  }
  const auto plan = make_plan(hdr, overlapping);
  REQUIRE(plan);
  REQUIRE(plan->timing.group_count == 4);
  CHECK(plan->timing.groups[1].period_us == 9000 + 12000 - 700);
  CHECK(plan->timing.groups[3].period_us == 12000);
  CHECK(core::judge(plan->timing) == protocol::Refusal::kNone);
  auto fixed = overlapping;
  fixed.period_us = 13000;
  CHECK(make_plan(hdr, fixed).error().code == ResultCode::kValueOutOfRange);
}

TEST_CASE("what a frame must show follows from its pattern", "[plan]") {
  auto sequence = patterns::standard();
  sequence.frames.push_back(sequence.frames.back());
  const auto plan = make_plan(sequence, {});
  REQUIRE(plan);
  CHECK(plan->frames[0].phase);
  CHECK(plan->frames[0].stripes);
  CHECK_FALSE(plan->frames[8].stripes);  // bit 6: one edge over the whole projector
  CHECK(plan->frames[14].stripes);
  CHECK(plan->frames[15].bright);
  CHECK(plan->frames[16].dark);
  CHECK_FALSE(plan->frames[16].repeats);
  CHECK(plan->frames[17].repeats);
}

TEST_CASE("a projector that loads may ask for longer periods of single frames", "[plan]") {
  std::vector<std::uint32_t> least_us(17, 0);
  least_us[3] = least_us[4] = 70'000;
  least_us[8] = 5000;  // shorter than the period anyway
  const auto plan = make_plan(
      patterns::standard(),
      {.exposure_us = 8000, .settle_us = 1000, .readout_us = 6000, .period_us = 20'000, .least_period_us = least_us});
  REQUIRE(plan);
  REQUIRE(plan->timing.group_count == 3);
  CHECK(plan->timing.groups[0].frames == 3);
  CHECK(plan->timing.groups[1].frames == 2);
  CHECK(plan->timing.groups[1].period_us == 70'000);
  CHECK(plan->timing.groups[2].frames == 12);
  CHECK(plan->timing.groups[2].period_us == 20'000);
  CHECK(plan->duration_us == 15 * 20'000 + 2 * 70'000);
}
