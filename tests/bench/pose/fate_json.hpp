// A scene's fate as one line of JSON, by which a run is kept, continued and reported.
#pragma once

#include <string>

#include "bench/pose/judge.hpp"

namespace beltpick::bench {

struct SceneRecord {
  int scene = 0;
  std::string kind;
  SceneFate fate;
};

std::string to_line(const SceneRecord& record);
// Throws std::exception where the line is no record.
SceneRecord from_line(const std::string& line);

}  // namespace beltpick::bench
