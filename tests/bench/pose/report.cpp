#include "bench/pose/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/pose/quantile.hpp"

namespace beltpick::bench {
namespace {

using Json = nlohmann::json;

// What is counted, for a family, a kind of scene or all.
struct Tally {
  int parts = 0, known = 0, found = 0, wrong = 0, twice = 0;
  int visible = 0, visible_found = 0, measured = 0, measured_found = 0;
  std::vector<double> mm, deg;

  void add(const TruePartFate& p) {
    ++parts;
    if (!p.loaded) return;
    ++known;
    found += p.found ? 1 : 0;
    if (p.visible >= kRecallVisible) ++visible, visible_found += p.found ? 1 : 0;
    if (p.measured >= kRecallVisible) ++measured, measured_found += p.found ? 1 : 0;
    if (p.found) mm.push_back(p.error.mm), deg.push_back(p.error.deg);
  }
  void add(const FalsePose& p) { p.duplicate ? ++twice : ++wrong; }

  [[nodiscard]] static double share(int part, int whole) {
    return whole == 0 ? 1.0 : part / static_cast<double>(whole);
  }
  [[nodiscard]] double recall() const { return share(visible_found, visible); }
  [[nodiscard]] double recall_measured() const { return share(measured_found, measured); }
  [[nodiscard]] Json json() const {
    return {{"parts", parts},
            {"with_template", known},
            {"found", found},
            {"wrong", wrong},
            {"found_twice", twice},
            {"visible_60", visible},
            {"recall_visible_60", recall()},
            {"measured_60", measured},
            {"recall_measured_60", recall_measured()},
            {"median_mm", quantile(mm, 0.5)},
            {"p99_mm", quantile(mm, 0.99)},
            {"median_deg", quantile(deg, 0.5)},
            {"p99_deg", quantile(deg, 0.99)}};
  }
};

void print(const std::string& name, const Tally& t) {
  std::printf("%-18s %6d %6d %6d %5d %5d  %6.2f %% of %-6d %6.2f %% of %-6d  %.3f %.3f  %.3f %.3f\n", name.c_str(),
              t.parts, t.known, t.found, t.wrong, t.twice, 100 * t.recall(), t.visible, 100 * t.recall_measured(),
              t.measured, quantile(t.mm, 0.5), quantile(t.mm, 0.99), quantile(t.deg, 0.5), quantile(t.deg, 0.99));
}

struct Run {
  Tally all;
  std::map<std::string, Tally> by_part, by_kind;
  std::map<std::string, int> missed_why;
  std::vector<double> object_ms, segment_ms, locate_ms, decode_ms, range_ms, render_ms, all_ms;

  void add(const SceneRecord& record) {
    for (const TruePartFate& p : record.fate.parts) {
      all.add(p), by_part[p.part].add(p), by_kind[record.kind].add(p);
      if (p.loaded && !p.found && p.visible >= kRecallVisible) ++missed_why[p.why];
    }
    for (const FalsePose& p : record.fate.false_poses) all.add(p), by_part[p.part].add(p), by_kind[record.kind].add(p);
    const SceneFate& f = record.fate;
    object_ms.insert(object_ms.end(), f.found_object_ms.begin(), f.found_object_ms.end());
    segment_ms.push_back(f.segment_ms), locate_ms.push_back(f.locate_ms), decode_ms.push_back(f.decode_ms);
    range_ms.push_back(f.range_ms), render_ms.push_back(f.render_ms);
    all_ms.push_back(f.decode_ms + f.range_ms + f.segment_ms + f.locate_ms);
  }
};

void print_tables(const Run& run) {
  std::printf("%-18s %6s %6s %6s %5s %5s  %18s  %18s  %11s  %11s\n", "", "parts", "known", "found", "WRONG", "twice",
              "recall, 60% seen", "and measured", "mm 50% 99%", "deg 50% 99%");
  for (const auto& [name, tally] : run.by_part) print(name, tally);
  for (const auto& [name, tally] : run.by_kind) print("scenes: " + name, tally);
  print("all", run.all);
  for (const auto& [why, count] : run.missed_why) std::printf("  missed %5d  %s\n", count, why.c_str());
  const auto times = [](const char* name, const std::vector<double>& ms) {
    std::printf("  %-34s median %7.1f ms, 99 %% %7.1f ms\n", name, quantile(ms, 0.5), quantile(ms, 0.99));
  };
  std::printf("wall times, while all jobs ran:\n");
  times("decode, after the last frame", run.decode_ms), times("range image", run.range_ms);
  times("segment", run.segment_ms), times("locate, a scene", run.locate_ms);
  times("object segmented -> verified pose", run.object_ms), times("last frame -> all poses", run.all_ms);
  times("(making the scene)", run.render_ms);
}

}  // namespace

bool print_report(const Options& options, const std::vector<SceneRecord>& records) {
  Run run;
  for (const SceneRecord& record : records) run.add(record);
  if (!options.json_only) print_tables(run);
  Json line = run.all.json();
  line["seed"] = options.seed, line["first_scene"] = options.first_scene, line["scenes"] = records.size();
  for (const auto& [name, tally] : run.by_part) line["by_part"][name] = tally.json();
  for (const auto& [name, tally] : run.by_kind) line["by_kind"][name] = tally.json();
  line["missed"] = run.missed_why;
  line["object_ms"] = {{"median", quantile(run.object_ms, 0.5)}, {"p99", quantile(run.object_ms, 0.99)}};
  line["last_frame_to_all_poses_ms"] = {{"median", quantile(run.all_ms, 0.5)}, {"p99", quantile(run.all_ms, 0.99)}};
  // None wrong among n bounds the rate at 3 / n with 95 % (the rule of three).
  if (run.all.wrong == 0 && run.all.found > 0) line["wrong_rate_below_95"] = 3.0 / run.all.found;
  std::printf("%s\n", line.dump().c_str());
  return options.expect_recall <= 0.0 || (run.all.wrong == 0 && run.all.recall_measured() >= options.expect_recall);
}

}  // namespace beltpick::bench
