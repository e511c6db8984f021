// bench_pose: how often poses are right, wrong or missing. See --help (options.hpp).
#include <unistd.h>

#include <cstdio>
#include <exception>

#include "bench/pose/report.hpp"
#include "bench/pose/run.hpp"

int main(int argc, char** argv) {
  using namespace beltpick::bench;
  try {
    const Options options = read_options(argc, argv);
    if (options.peers) {
      constexpr const char* kProgram = BELTPICK_BENCH_DIR "/bench_pose_peers";
      execv(kProgram, argv);
      std::fprintf(stderr, "bench_pose: --peers: %s was not built: run deploy/setup peers, configure and build\n",
                   kProgram);
      return 1;
    }
    const PartPool pool = make_part_pool(options.families, options.templates);
    if (print_report(options, run_scenes(options, pool))) return 0;
    std::fputs("bench_pose: a pose is wrong, or fewer parts were found than expected\n", stderr);
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_pose: %s\n", error.what());
    return 1;
  }
}
