// What `beltpick teach` takes: time, memory and the template's size, by the mesh's number of triangles. The part is a
// bracket with a boss; its faces are halved until there are enough.
//   bench_teach [TRIANGLES...]      default 10000 100000 1000000
#include <sys/resource.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/clock.hpp"
#include "contract_io/mesh_io.hpp"
#include "support/shapes.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;

namespace {

constexpr double kAllowed_s = 30.0;
constexpr double kAllowed_mb = 32.0;

// Halves faces at the middle of their longest side, the first ones first, until there are `count`.
Mesh bracket_of(std::size_t count) {
  Mesh mesh = test::bracket();
  for (std::size_t f = 0; mesh.face.size() < count; ++f) {
    const auto face = mesh.face[f];
    std::size_t longest = 0;
    const auto length = [&](std::size_t k) {
      return (mesh.vertex_mm[face[(k + 1) % 3]] - mesh.vertex_mm[face[k]]).squaredNorm();
    };
    for (std::size_t k = 1; k < 3; ++k) longest = length(k) > length(longest) ? k : longest;
    const std::uint32_t a = face[longest], b = face[(longest + 1) % 3], c = face[(longest + 2) % 3];
    const auto middle = static_cast<std::uint32_t>(mesh.vertex_mm.size());
    mesh.vertex_mm.push_back(0.5F * (mesh.vertex_mm[a] + mesh.vertex_mm[b]));
    mesh.face.push_back({a, middle, c});
    mesh.face.push_back({middle, b, c});
    mesh.face[f] = mesh.face.back();
    mesh.face.pop_back();
  }
  return mesh;
}

struct Cost {
  bool done = false;
  double wall_s = 0.0, user_s = 0.0, peak_mb = 0.0;
};

Cost run(const std::string& command) {
  rusage before{}, after{};
  getrusage(RUSAGE_CHILDREN, &before);
  const Stopwatch watch;
  const int status = std::system(command.c_str());
  Cost cost;
  cost.wall_s = 1e-3 * watch.elapsed_ms();
  getrusage(RUSAGE_CHILDREN, &after);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  cost.done = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  cost.user_s = seconds(after.ru_utime) - seconds(before.ru_utime);
  cost.peak_mb = 1e-3 * static_cast<double>(after.ru_maxrss);  // of the greatest child so far
  return cost;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::size_t> counts;
  for (int i = 1; i < argc; ++i) counts.push_back(std::strtoul(argv[i], nullptr, 10));
  if (counts.empty()) counts = {10'000, 100'000, 1'000'000};
  const test::TempFolder folder;
  std::printf("%12s %10s %10s %12s %12s  allowed: %.0f s, %.0f MB\n", "triangles", "wall s", "user s", "peak MB",
              "template MB", kAllowed_s, kAllowed_mb);
  bool good = true;
  std::string json;
  for (const std::size_t count : counts) {
    const auto mesh = folder / "part.stl";
    const auto out = folder / "part.template";
    if (!contract_io::write_stl(mesh, bracket_of(count))) return 1;
    const Cost cost = run(std::string(BELTPICK_BIN_DIR) + "/beltpick teach " + mesh.string() + " --out " +
                          out.string() + " --report " + (folder / "report").string() + " > /dev/null 2>&1");
    const double mb = cost.done ? 1e-6 * static_cast<double>(std::filesystem::file_size(out)) : 0.0;
    good = good && cost.done && cost.wall_s <= kAllowed_s && mb <= kAllowed_mb;
    std::printf("%12zu %10.2f %10.2f %12.0f %12.2f%s\n", count, cost.wall_s, cost.user_s, cost.peak_mb, mb,
                cost.done ? "" : "  FAILED");
    char line[160];
    std::snprintf(line, sizeof line,
                  "%s{\"triangles\": %zu, \"wall_s\": %.2f, \"user_s\": %.2f, \"template_mb\": %.2f}",
                  json.empty() ? "" : ", ", count, cost.wall_s, cost.user_s, mb);
    json += line;
  }
  std::printf("{\"teach\": [%s], \"within_limits\": %s}\n", json.c_str(), good ? "true" : "false");
  return good ? 0 : 1;
}
