#include <catch2/catch.hpp>

#include <thread>

#include "base/ring.hpp"

TEST_CASE("a full ring refuses, an empty one has nothing", "[ring]") {
  beltpick::Ring<int, 4> ring;
  CHECK_FALSE(ring.pop().has_value());
  for (int i = 0; i < 4; ++i) CHECK(ring.push(i));
  CHECK_FALSE(ring.push(4));
  CHECK(ring.pop() == 0);
  CHECK(ring.push(4));
}

TEST_CASE("items arrive once and in order across threads", "[ring]") {
  beltpick::Ring<int, 64> ring;
  constexpr int kItems = 200000;
  std::thread producer([&] {
    for (int i = 0; i < kItems;) {
      if (ring.push(i))
        ++i;
      else
        std::this_thread::yield();
    }
  });
  int expected = 0;
  while (expected < kItems) {
    if (const auto item = ring.pop()) {
      if (*item != expected) {
        FAIL("out of order");
      }
      ++expected;
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();
  CHECK(expected == kItems);
}
