#include <catch2/catch.hpp>

#include "base/arena.hpp"

using beltpick::Arena;
using beltpick::ArenaBlock;

namespace {
// What a stage does: the same code measures and takes.
void take_all(Arena& arena) {
  arena.take<float>("floats", 7);
  arena.take_image<std::uint16_t>("picture", 5, 3);
  arena.take<float>("floats", 1);
}
}  // namespace

TEST_CASE("a measuring arena predicts exactly what the real one uses", "[arena]") {
  Arena measuring;
  take_all(measuring);
  ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  take_all(arena);
  CHECK(arena.used_bytes() == measuring.used_bytes());
  CHECK(arena.used_bytes() == block.bytes());
}

TEST_CASE("shares are named, aligned, zeroed and added up by name", "[arena]") {
  ArenaBlock block(4096);
  Arena arena(block.data(), block.bytes());
  const auto floats = arena.take<float>("floats", 7);
  const auto picture = arena.take_image<std::uint16_t>("picture", 5, 3);
  arena.take<float>("floats", 1);
  CHECK(reinterpret_cast<std::uintptr_t>(picture.data) % 64 == 0);
  for (const float value : floats) CHECK(value == 0.0F);
  REQUIRE(arena.shares().size() == 2);
  CHECK(std::string(arena.shares()[0].name) == "floats");
  CHECK(arena.shares()[0].bytes == 128);
  CHECK(picture.rows == 5);
  CHECK(picture.stride == 3);
}
