// Templates of this beltpick, of earlier and of later ones.
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstring>

#include <zlib.h>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/template_io.hpp"
#include "support/json_file.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

PartTemplate small_part() {
  PartTemplate part;
  part.point_mm = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 2}};
  part.normal.assign(4, Vec3f::UnitZ());
  part.spacing_mm = 2.0;
  part.box_max_mm = {4, 3, 2};
  Primitive face;
  face.kind = PrimitiveKind::kPlane;
  face.direction = Vec3::UnitZ();
  part.primitives = {face};
  part.routes = {{0, 0.5, 600}, {-1, 1.0, 3888}};
  part.steps = {0.25, 3.0};
  part.requirements = Requirements{.support = 0.4, .residual = 0.25};
  return part;
}

std::string bytes_of(const PartTemplate& part) {
  const TempFolder folder;
  REQUIRE(contract_io::write_template(folder / "part.template", part));
  return contract_io::read_file(folder / "part.template").value();
}

// The file with another version in its first line, and its JSON changed; its checksum is right.
template <class Change>
std::string changed(const std::string& bytes, int version, Change change) {
  const std::size_t line = bytes.find('\n');
  unsigned long json_bytes = 0;
  REQUIRE(std::sscanf(bytes.c_str(), "beltpick-template %*d %*x %lu", &json_bytes) == 1);
  nlohmann::json json = nlohmann::json::parse(bytes.substr(line + 1, json_bytes));
  change(json);
  const std::string text = json.dump();
  const std::string rest = text + bytes.substr(line + 1 + json_bytes);
  char head[80];
  std::snprintf(head, sizeof head, "beltpick-template %d %08lx %zu\n", version,
                crc32(0, reinterpret_cast<const unsigned char*>(rest.data()), static_cast<unsigned>(rest.size())),
                text.size());
  return head + rest;
}

}  // namespace

TEST_CASE("a template keeps what teaching found out", "[template]") {
  const PartTemplate part = small_part();
  const auto read = contract_io::parse_template(bytes_of(part), "part", "part.template");
  REQUIRE(read);
  REQUIRE(read->routes.size() == 2);
  CHECK(read->routes[0].primitive == 0);
  CHECK(read->routes[0].poses == 600);
  CHECK(read->routes[1].primitive == -1);
  CHECK(read->steps.turn_rad == 0.25);
  CHECK(read->steps.shift_mm == 3.0);
  REQUIRE(read->requirements);
  CHECK(*read->requirements == *part.requirements);
}

TEST_CASE("a template of an earlier beltpick is read, and has nothing of what came later", "[template]") {
  const std::string earlier = changed(bytes_of(small_part()), 1, [](nlohmann::json& json) {
    for (const char* later : {"gripper", "cones", "resting_positions", "routes", "search_steps", "requirements"})
      json.erase(later);
  });
  const auto read = contract_io::parse_template(earlier, "part", "part.template");
  REQUIRE(read);
  CHECK(read->point_mm == small_part().point_mm);
  CHECK(read->primitives.size() == 1);
  CHECK(read->routes.empty());
  CHECK(read->steps.turn_rad == 0.0);
  CHECK_FALSE(read->requirements);
  CHECK_FALSE(read->gripper);
}

TEST_CASE("a later template is read without what this beltpick does not know; a later version is refused by name",
          "[template]") {
  const auto add = [](nlohmann::json& json) {
    json["weight_g"] = 120;
    json["requirements"] = {{"support", 0.3}, {"shine", 0.1}};
  };
  const auto read = contract_io::parse_template(changed(bytes_of(small_part()), 1, add), "part", "part.template");
  REQUIRE(read);
  CHECK(read->requirements->support == 0.3);
  CHECK(read->requirements->residual == Requirements{}.residual);
  for (const int version : {0, 2}) {
    const auto refused =
        contract_io::parse_template(changed(bytes_of(small_part()), version, [](auto&) {}), "part", "old.template");
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ResultCode::kVersionUnsupported);
    INFO(refused.error().detail);
    CHECK(std::strstr(refused.error().detail, "old.template: version: expected 1, found") != nullptr);
    CHECK(std::strstr(refused.error().detail, "teach the part again") != nullptr);
  }
}

TEST_CASE("requirements that are no shares are refused", "[template]") {
  for (const double wrong : {-0.1, 1.5}) {
    const auto spoil = [&](nlohmann::json& json) { json["requirements"]["coverage"] = wrong; };
    const auto refused =
        contract_io::parse_template(changed(bytes_of(small_part()), 1, spoil), "part", "part.template");
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ResultCode::kValueOutOfRange);
  }
}
