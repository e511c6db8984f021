#include <catch2/catch.hpp>

#include "capture/frame_ids.hpp"

using beltpick::capture::frames_between;

TEST_CASE("frame ids of 16 bits wrap from 65535 to 1", "[frame ids]") {
  CHECK(frames_between(1, 2) == 1);
  CHECK(frames_between(65534, 65535) == 1);
  CHECK(frames_between(65535, 1) == 1);
  CHECK(frames_between(65535, 2) == 2);
  CHECK(frames_between(65530, 4) == 9);
  CHECK(frames_between(7, 7) == 0);
  CHECK(frames_between(2, 1) == -1);
  CHECK(frames_between(1, 65535) == -1);
}

TEST_CASE("frame ids of 64 bits run on", "[frame ids]") {
  CHECK(frames_between(65535, 65536) == 1);
  CHECK(frames_between(1'000'000, 1'000'003) == 3);
  CHECK(frames_between(1'000'003, 1'000'000) == -3);
}

TEST_CASE("stepping through two whole cycles never loses count", "[frame ids]") {
  std::uint64_t id = 60000;
  bool right = true;
  for (int i = 0; i < 140000; ++i) {
    const std::uint64_t next = id == 65535 ? 1 : id + 1;
    right = right && frames_between(id, next) == 1 && frames_between(next, id) == -1;
    id = next;
  }
  CHECK(right);
}
