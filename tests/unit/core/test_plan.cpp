#include <catch2/catch.hpp>

#include "bench.hpp"

using namespace bench;
using protocol::Refusal;

TEST_CASE("a sequence that the hardware can run is accepted", "[plan]") {
  CHECK(core::judge(sequence(1, 22)) == Refusal::kNone);
}

TEST_CASE("each way a sequence cannot run has its own refusal", "[plan]") {
  auto arm = sequence(1, 22);
  SECTION("no groups") {
    arm.group_count = 0;
    CHECK(core::judge(arm) == Refusal::kNoFrames);
  }
  SECTION("an empty group") {
    arm.groups[0].frames = 0;
    CHECK(core::judge(arm) == Refusal::kNoFrames);
  }
  SECTION("too many groups") {
    arm.group_count = protocol::kMaxGroups + 1;
    CHECK(core::judge(arm) == Refusal::kTooManyGroups);
  }
  SECTION("too many frames in all") {
    arm.group_count = 2;
    arm.groups[1] = arm.groups[0];
    arm.groups[1].frames = protocol::kMaxFrames;
    CHECK(core::judge(arm) == Refusal::kTooManyFrames);
  }
  SECTION("no exposure") {
    arm.groups[0].exposure_us = 0;
    CHECK(core::judge(arm) == Refusal::kExposureOutOfRange);
  }
  SECTION("an exposure beyond the longest") {
    arm.groups[0].exposure_us = protocol::kMaxExposure_us + 1;
    CHECK(core::judge(arm) == Refusal::kExposureOutOfRange);
  }
  SECTION("an exposure that would wrap the sums") {
    arm.groups[0].exposure_us = 0xFFFFFFFF;
    CHECK(core::judge(arm) == Refusal::kExposureOutOfRange);
  }
  SECTION("an exposure or a period shorter than the board's") {
    core::BoardTiming board;
    board.min_exposure_us = 8000;
    board.min_period_us = 12500;
    CHECK(core::judge(arm, board) == Refusal::kNone);
    board.min_exposure_us = 8001;
    CHECK(core::judge(arm, board) == Refusal::kExposureOutOfRange);
    board.min_exposure_us = 8000;
    board.min_period_us = 12501;
    CHECK(core::judge(arm, board) == Refusal::kPeriodTooShort);
  }
  SECTION("an interval between two edges of a pin below what the board's interrupts need") {
    core::BoardTiming board;
    board.min_interval_us = 1000;
    CHECK(core::judge(arm, board) == Refusal::kNone);
    arm.groups[0].exposure_us = 999;
    CHECK(core::judge(arm, board) == Refusal::kIntervalTooShort);
    arm.groups[0].exposure_us = 1000;
    arm.groups[0].settle_us = 999;
    CHECK(core::judge(arm, board) == Refusal::kIntervalTooShort);
  }
  SECTION("settle within the advance pulse") {
    arm.groups[0].settle_us = protocol::kAdvancePulse_us - 1;
    CHECK(core::judge(arm) == Refusal::kSettleTooShort);
  }
  SECTION("a period that is too long") {
    arm.groups[0].period_us = protocol::kMaxPeriod_us + 1;
    CHECK(core::judge(arm) == Refusal::kPeriodTooLong);
  }
  SECTION("exposure + readout beyond the period by one microsecond") {
    arm.groups[0].readout_us = 4500;
    CHECK(core::judge(arm) == Refusal::kNone);
    arm.groups[0].readout_us = 4501;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
  }
  SECTION("the strobe could reach into the next pattern") {
    arm.strobe_tolerance_us = 3500;
    CHECK(core::judge(arm) == Refusal::kNone);
    arm.strobe_tolerance_us = 3501;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
  }
  SECTION("readout, settle or tolerance that would wrap the sums") {
    const auto fits = arm;
    arm.groups[0].readout_us = 0xFFFFFFFF;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
    arm = fits;
    arm.groups[0].settle_us = 0xFFFFFFFF;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
    arm = fits;
    arm.strobe_tolerance_us = 0xFFFFFFFF;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
  }
  SECTION("a next group that settles faster brings the next pulse too close") {
    arm.groups[0].readout_us = 4400;
    arm.group_count = 2;
    arm.groups[1] = arm.groups[0];
    arm.groups[1].settle_us = 900;
    CHECK(core::judge(arm) == Refusal::kNone);
    arm.groups[1].settle_us = 899;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
  }
  SECTION("a camera that overlaps: period below exposure + gap, or below the readout, by one microsecond") {
    arm.groups[0].readout_us = 12500;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
    arm.groups[0].overlap_gap_us = 4500;
    CHECK(core::judge(arm) == Refusal::kNone);
    arm.groups[0].overlap_gap_us = 4501;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
    arm.groups[0].overlap_gap_us = 1;
    arm.groups[0].readout_us = 12501;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
  }
  SECTION("a camera that overlaps: a shorter exposure may not end before the readout it began in") {
    arm.groups[0].readout_us = 6500;
    arm.groups[0].overlap_gap_us = 100;
    arm.group_count = 2;
    arm.groups[1] = arm.groups[0];
    arm.groups[1].exposure_us = 2000;
    CHECK(core::judge(arm) == Refusal::kNone);
    arm.groups[1].exposure_us = 1999;
    CHECK(core::judge(arm) == Refusal::kPeriodTooShort);
  }
  SECTION("a host that may never speak") {
    arm.host_silence_ms = 0;
    CHECK(core::judge(arm) == Refusal::kMalformed);
  }
}

TEST_CASE("the cursor visits every frame with the timing of its group", "[plan]") {
  auto arm = sequence(1, 3);
  arm.group_count = 3;
  arm.groups[1].frames = 1;
  arm.groups[1].exposure_us = 77;
  arm.groups[2].frames = 2;
  arm.groups[2].exposure_us = 99;
  core::FrameCursor cursor;
  std::vector<std::uint32_t> exposures;
  do {
    CHECK(cursor.frame() == exposures.size());
    exposures.push_back(cursor.timing(arm).exposure_us);
  } while (cursor.advance(arm));
  CHECK(exposures == std::vector<std::uint32_t>{8000, 8000, 8000, 77, 99, 99});
  CHECK(core::total_frames(arm) == 6);
}
