#include "service/router.hpp"

#include <array>
#include <cstddef>

namespace beltpick::service {
namespace {

// Takes the next segment off a path: "/a/b" -> "a", leaving "/b".
std::string_view take_segment(std::string_view& path) {
  path.remove_prefix(1);
  const std::size_t end = path.find('/');
  const std::string_view segment = path.substr(0, end);
  path.remove_prefix(segment.size());
  return segment;
}

bool fill(std::string_view place, std::string_view segment, PathNames& names) {
  if (segment.empty()) return false;
  if (place == "{kind}") names.kind = segment;
  if (place == "{name}") names.name = segment;
  if (place == "{version}") names.version = segment;
  return true;
}

bool fits(std::string_view pattern, std::string_view path, PathNames& names) {
  while (pattern.starts_with('/') && path.starts_with('/')) {
    const std::string_view place = take_segment(pattern);
    const std::string_view segment = take_segment(path);
    if (place.starts_with('{') ? !fill(place, segment, names) : place != segment) return false;
  }
  return pattern.empty() && path.empty();
}

}  // namespace

std::string_view method_name(HttpMethod method) {
  static constexpr auto kNames = std::to_array<std::string_view>({"GET", "PUT", "POST", "DELETE"});
  return kNames[static_cast<std::size_t>(method)];
}

RouteMatch find_route(std::string_view method, std::string_view path) {
  RouteMatch match;
  for (const ApiRoute& route : kApiRoutes) {
    PathNames names;
    if (!fits(route.path, path, names)) continue;
    const std::string_view name = method_name(route.method);
    if (name == method || (method == "HEAD" && route.method == HttpMethod::kGet)) return {&route, names, ""};
    match.allow += (match.allow.empty() ? "" : ", ") + std::string(name);
  }
  return match;
}

}  // namespace beltpick::service
