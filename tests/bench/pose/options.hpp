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
  int first_scene = 0, scenes = 100;
  int jobs = 2;
  int rendered_every = 10;
  int width = 1280, height = 960;
  std::filesystem::path templates = "bench_pose_templates";
  std::filesystem::path records;  // empty: not kept
  std::filesystem::path explain;  // folder for one scene's capture
  std::optional<int> scene;       // this one alone
  bool json_only = false;
};

inline constexpr const char* kHelp =
    "bench_pose: how often the product's poses are right, wrong or missing, over scenes of the virtual cell\n"
    "  --seed S            of the run (default 1)\n"
    "  --scenes N          how many (default 100), of three to five parts each\n"
    "  --first K           the number of the first (default 0): ranges of one seed add up\n"
    "  --rendered-every N  of N lots of ten scenes one is rendered frame by frame and decoded, its parts settled\n"
    "                      (default 10; 1 all, 0 none); of the others the codes are cast, by the measured noise law\n"
    "  --records FILE      keep a line a scene here; a run that broke off goes on where it stood\n"
    "  --jobs J            processes (default 2)\n"
    "  --camera WxH        of the virtual camera (default 1280x960)\n"
    "  --families A,B      of the virtual cell's parts (default: all)\n"
    "  --templates DIR     taught templates are kept and taken from here (default bench_pose_templates)\n"
    "  --scene K           this scene alone\n"
    "  --explain DIR       with --scene: its cloud, labels, truth, templates and poses as files\n"
    "  --json              only the line of JSON\n"
    "Example: bench_pose --seed 3 --scenes 300 --records seed3.jsonl\n";

// Throws std::runtime_error with what is wrong.
Options read_options(int argc, char** argv);

}  // namespace beltpick::bench
