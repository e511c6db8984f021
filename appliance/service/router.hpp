// Which route of the API a method and a path mean. Everything comes from kApiRoutes.
#pragma once

#include <string>
#include <string_view>

#include "contract/api.hpp"

namespace beltpick::service {

// What stands in a path where the route has {kind}, {name}, {version}; views into the path.
struct PathNames {
  std::string_view kind, name, version;
};

struct RouteMatch {
  const ApiRoute* route = nullptr;  // null: no such route
  PathNames names;
  std::string allow;  // the path is there, but not for that method: the methods it has, "GET, PUT"
};

std::string_view method_name(HttpMethod method);

// `path` as it came, with nothing unescaped: no path of the API needs it. HEAD is a GET.
RouteMatch find_route(std::string_view method, std::string_view path);

}  // namespace beltpick::service
