// The main function of benches that go through the scenes one after the other and end with a table.
#pragma once

#include <cstdio>
#include <exception>

#include "bench/pose/options.hpp"
#include "bench/pose/part_pool.hpp"

namespace beltpick::bench {

// `Bench` is made of options and pool, runs each scene by its number, and prints.
template <class Bench>
int run_scene_loop(const char* program, int argc, char** argv) {
  try {
    const Options options = read_options(argc, argv);
    const PartPool pool = make_part_pool(options.families, options.templates);
    Bench bench(options, pool);
    const std::vector<int> scenes = scene_numbers(options);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      std::fprintf(stderr, "\r%zu/%zu", i, scenes.size());
      bench.run(scenes[i]);
    }
    std::fputs("\r", stderr);
    bench.print();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

}  // namespace beltpick::bench
