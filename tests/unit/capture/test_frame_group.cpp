#include <catch2/catch.hpp>

#include "capture/frame_group.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using capture::FrameGroup;

namespace {

protocol::FrameEvent exposure(std::uint16_t frame, std::uint32_t strobe_ticks) {
  protocol::FrameEvent event;
  event.frame = frame;
  event.strobe_ticks = strobe_ticks;
  event.strobe_length_ticks = 16000;
  return event;
}

// A capture of `wanted` frames whose images come as they should, from this id on.
void whole_capture(FrameGroup& group, int wanted, std::uint32_t triggers_before, std::uint64_t first_id) {
  REQUIRE(group.begin(wanted, triggers_before, 1));
  for (int i = 0; i < wanted; ++i) {
    const auto place = group.place(first_id + static_cast<std::uint64_t>(i));
    REQUIRE(place);
    CHECK(*place == i);
  }
  CHECK(group.frames() == wanted);
}

bool says(const Error& error, const char* what) { return error.text().find(what) != std::string_view::npos; }

}  // namespace

TEST_CASE("images find their exposures from capture to capture, whatever ids the camera began with", "[frame group]") {
  FrameGroup group;
  whole_capture(group, 4, 100, 7);
  whole_capture(group, 4, 104, 11);
  CHECK(group.late() == 0);
}

TEST_CASE("a lost image is named with its frame, its trigger and when it was exposed", "[frame group]") {
  FrameGroup group;
  whole_capture(group, 4, 100, 7);
  REQUIRE(group.begin(4, 104, 1));
  REQUIRE(group.place(11));
  group.exposed(exposure(1, 25040), 500);
  const auto next = group.place(13);
  REQUIRE_FALSE(next);
  CHECK(next.error().code == ResultCode::kFrameMissing);
  CHECK(says(next.error(), "frame 1 of 4 (trigger 106): exposed at 12.52 ms for 8.00 ms"));
  CHECK(says(next.error(), "id 13) is frame 2"));
}

TEST_CASE("a frame that was not even exposed is told from one whose image was lost", "[frame group]") {
  FrameGroup group;
  REQUIRE(group.begin(4, 0, 1));
  REQUIRE(group.place(1));
  CHECK(says(group.missing(), "frame 1 of 4 (trigger 2): lost, and its exposure was not told"));
  group.exposed(exposure(1, 25040), 500);
  CHECK(says(group.missing(), "exposed at 12.52 ms"));
}

TEST_CASE("late images of a capture that failed are not taken for frames of the next, and counted", "[frame group]") {
  FrameGroup group;
  whole_capture(group, 4, 100, 7);
  REQUIRE(group.begin(4, 104, 1));
  REQUIRE(group.place(11));
  // Given up after three pulses; two images of them come during the next capture.
  REQUIRE(group.begin(4, 107, 1));
  for (const std::uint64_t id : {12, 13}) {
    const auto place = group.place(id);
    REQUIRE(place);
    CHECK_FALSE(*place);
  }
  CHECK(group.late() == 2);
  const auto first = group.place(14);
  REQUIRE(first);
  CHECK(*first == 0);
}

TEST_CASE("an image more than the sequence has is extra", "[frame group]") {
  FrameGroup group;
  whole_capture(group, 2, 0, 1);
  const auto more = group.place(3);
  REQUIRE_FALSE(more);
  CHECK(more.error().code == ResultCode::kFrameExtra);
  CHECK(says(more.error(), "id 3, exposure 3"));
}

TEST_CASE("exposures that nobody triggered between two captures are told once", "[frame group]") {
  FrameGroup group;
  whole_capture(group, 2, 0, 1);
  group.came_idle(3);
  group.came_idle(4);
  const auto begun = group.begin(2, 2, 1);
  REQUIRE_FALSE(begun);
  CHECK(begun.error().code == ResultCode::kFrameExtra);
  CHECK(says(begun.error(), "found 2 that no pulse asked for"));
  whole_capture(group, 2, 2, 5);
  // Images of pulses that were given are none.
  group.came_idle(8);
  CHECK(group.begin(2, 6, 1));
}

TEST_CASE("a camera that was opened anew, or a firmware that was reset, is counted anew", "[frame group]") {
  FrameGroup group;
  whole_capture(group, 2, 50, 1);
  REQUIRE(group.begin(2, 52, 2));
  CHECK_FALSE(group.tied());
  CHECK(*group.place(900) == 0);
  REQUIRE(group.begin(2, 0, 2));
  CHECK_FALSE(group.tied());
  CHECK(*group.place(77) == 0);
}

TEST_CASE("frame ids of 16 bits wrap within a capture", "[frame group]") {
  FrameGroup group;
  REQUIRE(group.begin(3, 10, 1));
  CHECK(*group.place(65534) == 0);
  CHECK(*group.place(65535) == 1);
  CHECK(*group.place(1) == 2);
}
