// Trueness with the user's own calibration: noisy captures of a virtual plate -> beltpick calibrate -> planes, ball
// bars and step wedges of known size, decoded with that calibration.
//   bench_calibration [--seed S] [--captures N] [--targets N] [--keep DIR] [--calibration FILE] [--rig-calibration]
// The programs are used as a user would. --seed is of plate, poses, targets and noise; --targets is how many of each
// kind; --calibration judges a calibration that is there already, --rig-calibration the virtual cell's own, a fit of
// the model to its true lenses. Planes are judged by the means of 24 x 24 pixels (7.5 mm) against the plane through all
// points. Ends with one line of JSON.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.hpp"
#include "bench/calibration/targets.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_writer.hpp"
#include "contract_io/npy_io.hpp"
#include "contract_io/truth_io.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kLimit_mm = 0.03;
constexpr int kBlock_px = 24;
constexpr int kEdge_px = 4;
constexpr double kMaxIncidence_deg = 60.0;

struct Options {
  int seed = 1, captures = 15, targets = 4;
  std::string keep, calibration;
  bool rig_calibration = false;
};

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "bench_calibration: %s\n", result.error().detail);
  std::exit(1);
}

void run(const std::string& command) {
  if (std::system((std::string(BELTPICK_BIN_DIR) + "/beltpick " + command + " > /dev/null").c_str()) == 0) return;
  std::fprintf(stderr, "bench_calibration: 'beltpick %s' failed\n", command.c_str());
  std::exit(1);
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--rig-calibration") {
      options.rig_calibration = true;
      continue;
    }
    if (i + 1 == argc) {
      std::fprintf(stderr, "bench_calibration: expected a value after '%s'\n", name.c_str());
      std::exit(2);
    }
    const char* value = argv[++i];
    if (name == "--seed")
      options.seed = std::atoi(value);
    else if (name == "--captures")
      options.captures = std::atoi(value);
    else if (name == "--targets")
      options.targets = std::atoi(value);
    else if (name == "--keep")
      options.keep = value;
    else if (name == "--calibration")
      options.calibration = value;
    else {
      std::fprintf(stderr, "bench_calibration: unknown option '%s'; see the head of its source\n", name.c_str());
      std::exit(2);
    }
  }
  return options;
}

// Figures of one kind, over all its targets.
struct Tally {
  std::vector<double> errors_mm;

  void add(double error_mm) { errors_mm.push_back(error_mm); }
  [[nodiscard]] double worst_mm() const {
    double worst = 0.0;
    for (const double error_mm : errors_mm) worst = std::max(worst, std::abs(error_mm));
    return worst;
  }
  [[nodiscard]] double rms_mm() const {
    double sum = 0.0;
    for (const double error_mm : errors_mm) sum += error_mm * error_mm;
    return errors_mm.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(errors_mm.size()));
  }
};

struct Trueness {
  Tally plane_rms, plane_max, noise, radius, distance, step;
};

// One capture decoded with `calibration`, beside its truth.
struct Decoded {
  Truth truth;
  contract_io::NpyArray<float> xyz;
  contract_io::NpyArray<std::uint16_t> instances;

  Decoded(const fs::path& folder, const std::string& calibration) {
    const fs::path cloud = folder / "cloud.npy";
    run("decode " + folder.string() + " --calibration " + calibration + " --xyz " + cloud.string());
    contract_io::Warnings warnings;
    truth = need(contract_io::read_truth(folder / "truth.json", warnings));
    xyz = need(contract_io::read_npy<float>(cloud, {-1, -1, 3}));
    instances = need(contract_io::read_npy<std::uint16_t>(folder / truth.instances_file, {-1, -1}));
  }

  [[nodiscard]] TargetPoints points(const TrueTarget& target) const {
    const int rows = instances.shape[0], cols = instances.shape[1];
    return points_of(ImageView<const float>(xyz.values.data(), rows, 3 * cols),
                     ImageView<const std::uint16_t>(instances.values.data(), rows, cols), target.instance, kEdge_px);
  }
};

void judge_planes(const Decoded& decoded, Trueness& trueness) {
  for (const TrueTarget& target : decoded.truth.targets) {
    if (target.kind != TrueTarget::Kind::kPlane) continue;
    const PlaneTrueness plane = judge_plane(decoded.points(target), kBlock_px);
    if (plane.blocks == 0) continue;
    trueness.plane_rms.add(plane.low_pass_rms_mm);
    trueness.plane_max.add(plane.low_pass_max_mm);
    trueness.noise.add(plane.noise_rms_mm);
  }
}

void judge_balls(const Decoded& decoded, Trueness& trueness) {
  std::vector<Vec3> found_mm, true_mm;
  for (const TrueTarget& target : decoded.truth.targets) {
    if (target.kind != TrueTarget::Kind::kSphere) continue;
    const TargetPoints points = decoded.points(target);
    if (points.point_mm.size() < 100) continue;
    const Ball ball = fit_ball(points, target.point_camera_mm, kMaxIncidence_deg);
    trueness.radius.add(ball.radius_mm - target.radius_mm);
    found_mm.push_back(ball.centre_mm);
    true_mm.push_back(target.point_camera_mm);
  }
  for (std::size_t i = 1; i < found_mm.size(); ++i) {
    trueness.distance.add((found_mm[i] - found_mm[0]).norm() - (true_mm[i] - true_mm[0]).norm());
  }
}

void judge_steps(const Decoded& decoded, Trueness& trueness) {
  std::vector<TargetPoints> steps;
  std::vector<double> true_mm;
  for (const TrueTarget& target : decoded.truth.targets) {
    if (target.kind != TrueTarget::Kind::kPlane) continue;
    TargetPoints points = decoded.points(target);
    if (points.point_mm.size() < 200) continue;
    steps.push_back(std::move(points));
    true_mm.push_back(target.height_mm);
  }
  if (steps.size() < 2) return;
  const std::vector<double> heights_mm = step_heights_mm(steps);
  for (std::size_t i = 1; i < steps.size(); ++i) trueness.step.add(heights_mm[i] - (true_mm[i] - true_mm[0]));
}

std::vector<fs::path> captures_in(const fs::path& folder) {
  std::vector<fs::path> captures;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / "capture.json")) captures.push_back(entry.path());
  }
  if (captures.empty()) captures.push_back(folder);
  std::sort(captures.begin(), captures.end());
  return captures;
}

// The captures of one kind of target, rendered where they are not there yet.
std::vector<fs::path> render(const fs::path& folder, const std::string& scene, int count, int seed) {
  if (!fs::exists(folder)) {
    run("simulate --out " + folder.string() + " --scene " + scene + " --count " + std::to_string(count) + " --seed " +
        std::to_string(seed));
  }
  return captures_in(folder);
}

std::string calibrate(const Options& options, const fs::path& folder) {
  if (!options.calibration.empty()) return options.calibration;
  const auto plates = render(folder / "plates", "plate --board 11x8 --square-mm 20", options.captures, options.seed);
  if (options.rig_calibration) return (plates.front() / "calibration.json").string();
  std::string command = "calibrate";
  for (const fs::path& plate : plates) command += " " + plate.string();
  const std::string calibration = (folder / "calibration.json").string();
  run(command + " --board 11x8 --square-mm 20 --out " + calibration + " --report " + (folder / "report").string());
  return calibration;
}

contract_io::Json row(const char* what, const Tally& tally, double value_mm, bool judged) {
  std::printf("%-34s %7zu %9.4f %9.4f   %s\n", what, tally.errors_mm.size(), tally.rms_mm(), tally.worst_mm(),
              !judged ? "" : (value_mm <= kLimit_mm ? "reached" : "MISSED"));
  contract_io::Json json = {
      {"count", tally.errors_mm.size()}, {"rms_mm", tally.rms_mm()}, {"worst_mm", tally.worst_mm()}};
  if (judged) json["reached"] = value_mm <= kLimit_mm;
  return json;
}

int main_of(const Options& options) {
  const test::TempFolder temporary;
  const fs::path folder = options.keep.empty() ? temporary.path() : fs::path(options.keep);
  fs::create_directories(folder);
  const std::string calibration = calibrate(options, folder);
  Trueness trueness;
  const int seed = options.seed + 1000;  // the targets are not the plate's places again
  for (const fs::path& capture : render(folder / "planes", "planes", options.targets, seed)) {
    judge_planes(Decoded(capture, calibration), trueness);
  }
  for (const fs::path& capture : render(folder / "balls", "sphere", options.targets, seed)) {
    judge_balls(Decoded(capture, calibration), trueness);
  }
  for (const fs::path& capture : render(folder / "steps", "steps", options.targets, seed)) {
    judge_steps(Decoded(capture, calibration), trueness);
  }
  std::printf("%-34s %7s %9s %9s   at most %.2f mm\n", "against the truth", "count", "rms mm", "worst mm", kLimit_mm);
  contract_io::Json json = {{"seed", options.seed}, {"captures", options.captures}, {"limit_mm", kLimit_mm}};
  json["plane_low_pass_rms"] = row("plane, low-pass rms", trueness.plane_rms, trueness.plane_rms.worst_mm(), true);
  json["plane_low_pass_max"] = row("plane, low-pass largest", trueness.plane_max, 0.0, false);
  json["plane_noise_rms"] = row("plane, noise about the low-pass", trueness.noise, 0.0, false);
  json["ball_radius"] = row("ball radius", trueness.radius, trueness.radius.worst_mm(), true);
  json["ball_distance"] = row("ball distance", trueness.distance, trueness.distance.worst_mm(), true);
  json["step_height"] = row("step height", trueness.step, trueness.step.worst_mm(), true);
  std::printf("%s\n", json.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) { return beltpick::bench::main_of(beltpick::bench::parse(argc, argv)); }
