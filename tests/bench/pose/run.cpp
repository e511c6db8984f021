#include "bench/pose/run.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <map>
#include <new>
#include <stdexcept>

#include "bench/pose/scene_bench.hpp"
#include "bench/pose/scene_dump.hpp"

namespace beltpick::bench {
namespace {

SceneRecord run_scene(SceneBench& bench, const Options& options, const PartPool& pool, int k) {
  const SceneBench::Scene scene = bench.run(k);
  SceneRecord record{k, std::string(kSceneKindNames[static_cast<std::size_t>(scene.plan.kind)]),
                     judge(scene.seen, scene.plan, pool, bench.machine(), scene.located)};
  record.fate.render_ms = scene.making_ms;
  if (!options.explain.empty()) {
    std::vector<const PartTemplate*> templates;
    for (const int index : scene.plan.loaded) templates.push_back(&pool.templates[static_cast<std::size_t>(index)]);
    write_scene(options.explain, scene.seen, bench.calibration(), templates, scene.located, record);
  }
  return record;
}

// Scenes of equal templates, which one process loads once.
using Lot = std::vector<int>;

std::vector<Lot> lots_of(const std::vector<int>& scenes) {
  std::vector<Lot> lots;
  for (const int k : scenes) {
    if (lots.empty() || lots.back().back() / kScenesAlike != k / kScenesAlike) lots.emplace_back();
    lots.back().push_back(k);
  }
  return lots;
}

// A number that all processes count up: the next lot to be taken.
class SharedCount {
 public:
  SharedCount() : memory_(mmap(nullptr, sizeof(Count), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::runtime_error("no memory to share");
    count_ = new (memory_) Count(0);
  }
  ~SharedCount() { munmap(memory_, sizeof(Count)); }
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;

  std::size_t take() { return count_->fetch_add(1); }

 private:
  using Count = std::atomic<std::size_t>;
  void* memory_;
  Count* count_ = nullptr;
};

// Runs one lot after the other, as long as there is one that no other process took, and writes their records to `out`.
void work(const Options& options, const PartPool& pool, const std::vector<Lot>& lots, SharedCount& next, FILE* out) {
  SceneBench bench(options, pool);
  for (std::size_t lot = next.take(); lot < lots.size(); lot = next.take()) {
    for (const int k : lots[lot]) {
      std::fputs((to_line(run_scene(bench, options, pool, k)) + "\n").c_str(), out);
      std::fflush(out);
    }
  }
}

void tell(const SceneRecord& record, std::size_t done, std::size_t all) {
  std::fprintf(stderr, "\r%zu/%zu", done, all);
  for (const FalsePose& p : record.fate.false_poses) {
    std::fprintf(stderr, "\rscene %d (%s): %s %s, nearest %s, %.2f mm %.2f deg, score %.3f coverage %.2f\n",
                 record.scene, record.kind.c_str(), p.duplicate ? "found twice:" : "WRONG:", p.part.c_str(),
                 p.nearest.c_str(), p.error.mm, p.error.deg, p.score, p.coverage);
  }
  for (const TruePartFate& p : record.fate.parts) {
    if (!p.loaded || p.found || p.visible < kRecallVisible) continue;
    std::fprintf(stderr, "\rscene %d (%s): missed %s, %.2f visible, %.2f measured: %s\n", record.scene,
                 record.kind.c_str(), p.part.c_str(), p.visible, p.measured, p.why.c_str());
  }
}

std::map<int, SceneRecord> kept(const Options& options, const std::vector<int>& asked) {
  std::map<int, SceneRecord> records;
  std::ifstream file(options.records);
  for (std::string line; std::getline(file, line);) {
    const SceneRecord record = from_line(line);
    if (std::binary_search(asked.begin(), asked.end(), record.scene)) records[record.scene] = record;
  }
  return records;
}

// Reads the lines of all workers as they come.
void collect(FILE* lines, const Options& options, std::size_t left, std::map<int, SceneRecord>& records) {
  std::ofstream keep;
  if (!options.records.empty()) keep.open(options.records, std::ios::app);
  const std::size_t all = records.size() + left;
  char* line = nullptr;
  std::size_t room = 0;
  while (getline(&line, &room, lines) > 0) {
    const SceneRecord record = from_line(line);
    keep << line << std::flush;
    records[record.scene] = record;
    tell(record, records.size(), all);
  }
  std::fputs("\r", stderr);
  free(line);
}

}  // namespace

std::vector<SceneRecord> run_scenes(const Options& options, const PartPool& pool) {
  std::vector<int> scenes = scene_numbers(options);
  std::map<int, SceneRecord> records = kept(options, scenes);
  std::erase_if(scenes, [&](int k) { return records.contains(k); });
  const std::vector<Lot> lots = lots_of(scenes);
  SharedCount next;
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  std::vector<pid_t> children;
  for (int job = 0; job < options.jobs; ++job) {
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
      close(ends[0]);
      FILE* out = fdopen(ends[1], "w");
      int status = 0;
      try {
        work(options, pool, lots, next, out);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_pose: %s\n", error.what());
        status = 1;
      }
      std::fflush(out);
      _exit(status);
    }
    children.push_back(child);
  }
  close(ends[1]);
  FILE* lines = fdopen(ends[0], "r");
  collect(lines, options, scenes.size(), records);
  std::fclose(lines);
  bool sound = true;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    sound = sound && status == 0;
  }
  if (!sound) throw std::runtime_error("a worker failed; with --records the run goes on where it stood");
  std::vector<SceneRecord> in_order;
  for (auto& [k, record] : records) in_order.push_back(std::move(record));
  return in_order;
}

}  // namespace beltpick::bench
