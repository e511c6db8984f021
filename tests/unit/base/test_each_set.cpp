#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "base/each_set.hpp"
#include "base/random.hpp"

using namespace beltpick;

namespace {

template <class Element>
void visits_what_is_not_zero(std::size_t size, std::uint32_t one_in) {
  Random random(size + one_in);
  std::vector<Element> elements(size);
  std::vector<std::size_t> expected, visited;
  for (std::size_t i = 0; i < size; ++i) {
    if (random.below(one_in) == 0) elements[i] = static_cast<Element>(1 + i % 200), expected.push_back(i);
  }
  each_set(std::span<const Element>(elements), [&](std::size_t i) { visited.push_back(i); });
  CHECK(visited == expected);
}

}  // namespace

TEST_CASE("each element that is not zero is visited once, in order, whatever the size", "[each_set]") {
  for (const std::size_t size : {0U, 1U, 3U, 7U, 8U, 9U, 31U, 64U, 1000U, 1001U}) {
    for (const std::uint32_t one_in : {1U, 2U, 50U, 100000U}) {
      visits_what_is_not_zero<std::uint8_t>(size, one_in);
      visits_what_is_not_zero<std::uint16_t>(size, one_in);
    }
  }
}
