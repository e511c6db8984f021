// Routes are found from the table alone; whatever is not exactly one of them is none.
#include <catch2/catch.hpp>
#include <string>

#include "base/random.hpp"
#include "contract/result_codes.hpp"
#include "service/gate.hpp"
#include "service/router.hpp"

using namespace beltpick;
using namespace beltpick::service;

namespace {

// A path that a route's pattern describes.
std::string example_of(std::string_view pattern) {
  std::string path(pattern);
  for (const auto& [place, text] :
       {std::pair<std::string, std::string>{"{kind}", "template"}, {"{name}", "knuckle.v-2_a"}, {"{version}", "17"}}) {
    if (const auto at = path.find(place); at != std::string::npos) path.replace(at, place.size(), text);
  }
  return path;
}

}  // namespace

TEST_CASE("every route is found by its own method and path", "[router]") {
  for (const ApiRoute& route : kApiRoutes) {
    const std::string path = example_of(route.path);
    INFO(method_name(route.method) << " " << path);
    const RouteMatch match = find_route(method_name(route.method), path);
    REQUIRE(match.route == &route);
    CHECK((route.path.find("{name}") == std::string_view::npos || match.names.name == "knuckle.v-2_a"));
    CHECK((route.path.find("{version}") == std::string_view::npos || match.names.version == "17"));
    CHECK(find_route("BREW", path).route == nullptr);
    CHECK_FALSE(find_route("BREW", path).allow.empty());
  }
  CHECK(find_route("HEAD", "/api/v1/health").route == find_route("GET", "/api/v1/health").route);
  CHECK(find_route("POST", "/api/v1/items/template/knuckle").allow == "GET, PUT, DELETE");
}

TEST_CASE("a path that is not one of the table's leads nowhere", "[router]") {
  for (const char* path :
       {"", "/", "*", "api/v1/health", "/api/v1", "/api/v1/", "/api/v1/health/", "//api/v1/health", "/api/v1//health",
        "/API/v1/health", "/api/v1/health%00", "/api/v1/./health", "/api/v1/items/template", "/api/v1/items/template/",
        "/api/v1/items//knuckle", "/api/v1/items/template/knuckle/versions/", "/api/v1/tokens/",
        "/api/v1/items/template/knuckle/rollback/3", "https://localhost/api/v1/health"}) {
    INFO(path);
    const RouteMatch match = find_route("GET", path);
    CHECK(match.route == nullptr);
    CHECK(match.allow.empty());
  }
}

TEST_CASE("no mutation of a path reaches a route that does not describe it", "[router]") {
  Random random(20260131);
  for (int i = 0; i < 100'000; ++i) {
    const ApiRoute& route = kApiRoutes[random.below(static_cast<std::uint32_t>(kApiRoutes.size()))];
    std::string path = example_of(route.path);
    for (std::uint32_t edit = random.below(3); edit-- > 0;) {
      path[random.below(static_cast<std::uint32_t>(path.size()))] = static_cast<char>(random.below(256));
    }
    const RouteMatch match = find_route(method_name(route.method), path);
    if (match.route == nullptr) continue;
    std::string again(match.route->path);
    for (const auto& [place, text] : {std::pair<std::string, std::string_view>{"{kind}", match.names.kind},
                                      {"{name}", match.names.name},
                                      {"{version}", match.names.version}}) {
      if (const auto at = again.find(place); at != std::string::npos) again.replace(at, place.size(), text);
    }
    REQUIRE(again == path);
  }
}

TEST_CASE("an item's path names a kind and a name of it", "[router]") {
  CHECK(item_of({"template", "knuckle", ""})->name == "knuckle");
  CHECK(item_of({"calibration", "calibration", ""})->kind == ItemKind::kCalibration);
  for (const PathNames& names :
       {PathNames{"calibration", "other", ""}, PathNames{"secret", "secret", ""}, PathNames{"template", "..", ""},
        PathNames{"template", "%2e%2e", ""}, PathNames{"recipe", ".hidden", ""}, PathNames{"", "", ""}}) {
    INFO(names.kind << "/" << names.name);
    const auto item = item_of(names);
    REQUIRE_FALSE(item);
    CHECK(item.error().code == ResultCode::kRouteUnknown);
  }
  CHECK_FALSE(item_of({"template", std::string(kMaxItemName + 1, 'a'), ""}));
}
