// What bench_pose is asked to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace beltpick::bench {

struct Options {
  std::vector<std::string> families{"knuckle", "elbow", "bracket", "balljoint", "sheet"};
  std::uint64_t seed = 1;
  int first_scene = 0, scenes = 100, stride = 1;
  int jobs = 2;
  int rendered_every = 10;
  std::vector<std::string> kinds;  // of scenes; empty: all
  int parts = 0;                   // in each scene; 0: three to seven
  double noise_mm = 0.0;           // instead of what the noise law gives; 0: the law
  int workers = 1;                 // threads that look for poses, in each process
  int repeats = 1;                 // of the search of each scene, whose times are the least
  int width = 1280, height = 960;
  std::filesystem::path templates = BELTPICK_BENCH_DIR "/pose_templates";
  std::filesystem::path records;  // empty: not kept
  std::filesystem::path explain;  // folder for one scene's capture
  std::optional<int> scene;       // this one alone
  double expect_recall = 0.0;     // of parts of which 60 % were measured; more than 0: also that nothing is wrong
  bool json_only = false;
  bool peers = false;
};

inline constexpr const char* kHelp =
    "bench_pose: how often the product's poses are right, wrong or missing, over scenes of the virtual cell\n"
    "  --seed S            of the run (default 1)\n"
    "  --scenes N          how many (default 100), of three to seven parts each\n"
    "  --first K           the number of the first (default 0): ranges of one seed add up\n"
    "  --stride N          every N-th only: ten in a row have the same templates, so 10 gives as many kinds and "
    "families\n"
    "                      as scenes\n"
    "  --rendered-every N  of N lots of ten scenes one is rendered frame by frame and decoded, its parts settled\n"
    "                      (default 10; 1 all, 0 none); of the others the codes are cast, by the measured noise law\n"
    "  --kinds A,B         only such scenes: apart, heap, mixed, foreign, twins (default all)\n"
    "  --parts N           so many parts in each scene\n"
    "  --noise-mm X        points off by so much (standard deviation) instead of codes by the noise law\n"
    "  --workers W         threads that look for poses, in each process (default 1)\n"
    "  --repeats R         each scene is searched so often, and the least of each time is told: without what else the\n"
    "                      machine does (default 1)\n"
    "  --records FILE      keep a line a scene here; a run that broke off goes on where it stood\n"
    "  --jobs J            processes (default 2)\n"
    "  --camera WxH        of the virtual camera (default 1280x960)\n"
    "  --families A,B      of the virtual cell's parts (default: all)\n"
    "  --templates DIR     taught templates are kept and taken from here (default: bench/pose_templates of the build)\n"
    "  --scene K           this scene alone\n"
    "  --explain DIR       with --scene: its cloud, labels, truth, templates and poses as files\n"
    "  --expect-recall R   fail where a pose is wrong or less than this share of the parts of which 60 % were "
    "measured\n"
    "                      is found: for tests\n"
    "  --peers             beside VTK's ICP, PCL's ICP and OpenCV's point pair features (deploy/setup peers), on one "
    "core\n"
    "  --json              only the line of JSON\n"
    "Examples:\n"
    "  the bulk        bench_pose --seed 3 --scenes 2400 --records seed3.jsonl\n"
    "  one scene       bench_pose --seed 3 --scene 17 --explain scene17\n"
    "  accuracy        bench_pose --seed 3 --scenes 100 --kinds apart --noise-mm 0.05 --rendered-every 0\n"
    "  one core        bench_pose --seed 3 --scenes 30 --kinds apart --parts 3 --rendered-every 1 --jobs 1 --repeats "
    "3\n"
    "  peers           bench_pose --peers --seed 3 --scenes 20 --stride 10 --kinds apart,heap\n"
    "  two cores       the same with --workers 2\n";

// Throws std::runtime_error with what is wrong.
Options read_options(int argc, char** argv);

// The numbers of the scenes that are asked for, rising.
std::vector<int> scene_numbers(const Options& options);

}  // namespace beltpick::bench
