// What decoding and triangulation cost and what noise comes out, on a plane of the virtual cell:
//   bench_decode [SEED]                 simulates the plane scene with that seed (default 1)
//   bench_decode CAPTURE                a folder of `beltpick simulate`
// Prints a table and, as its last line, JSON. Times are this thread's, the median of 15 passes, each beside a memcpy of
// the same frames: compare the ratios. Noise: distance to the truth along z, what varies slower than 31 pixels removed.
#include <time.h>
#include <algorithm>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/npy_io.hpp"
#include "decode/decoder.hpp"
#include "range/triangulator.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::bench {
namespace {

constexpr int kPasses = 15;

struct Loaded {
  CaptureHeader header;
  Calibration calibration;
  std::vector<contract_io::GreyImage> frames;
  std::vector<float> truth_mm;  // rows x cols x 3
};

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "bench_decode: %s\n", result.error().detail);
  std::exit(1);
}

Loaded load(const std::filesystem::path& folder) {
  contract_io::Warnings warnings;
  auto reader = need(contract_io::CaptureReader::open(folder, warnings));
  Loaded loaded{reader.header(), need(contract_io::read_calibration(folder / "calibration.json", warnings)), {}, {}};
  for (int i = 0; i < reader.frames(); ++i) loaded.frames.push_back(need(reader.image(i, warnings)));
  loaded.truth_mm = need(contract_io::read_npy<float>(folder / "truth_xyz.npy", {-1, -1, 3})).values;
  return loaded;
}

// Time that this thread computed: neighbours on the machine do not count.
class CpuWatch {
 public:
  [[nodiscard]] double elapsed_ms() const { return now_ms() - start_ms_; }

 private:
  static double now_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }
  double start_ms_ = now_ms();
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Times {
  double memcpy_ms = 0.0, fold_ms = 0.0, finish_ms = 0.0, range_ms = 0.0;
};

void need(const Result<void>& result) {
  if (result) return;
  std::fprintf(stderr, "bench_decode: %s\n", result.error().detail);
  std::exit(1);
}

struct Stages {
  decode::Decoder decoder;
  range::Triangulator triangulator;

  Stages(Arena& arena, const decode::DecoderLimits& limits)
      : decoder(arena, limits), triangulator(arena, limits.rows, limits.cols) {}
};

// Fills `range` with the last pass's points.
Times time_passes(const Loaded& loaded, const decode::FoldPlan& plan, Stages& stages, RangeImage& range) {
  std::vector<double> copies, folds, finishes, ranges;
  const contract_io::GreyImage& first = loaded.frames.front();
  const std::size_t frame_bytes = first.pixels8.size();
  std::vector<std::uint8_t> target(frame_bytes * loaded.frames.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    CpuWatch watch;
    for (std::size_t i = 0; i < loaded.frames.size(); ++i) {
      std::memcpy(&target[i * frame_bytes], loaded.frames[i].pixels8.data(), frame_bytes);
    }
    copies.push_back(watch.elapsed_ms());
    need(stages.decoder.begin(plan, first.rows, first.cols, 1, loaded.header.full_scale));
    watch = CpuWatch();
    for (std::size_t i = 0; i < loaded.frames.size(); ++i) {
      need(stages.decoder.fold(static_cast<int>(i), loaded.frames[i].view8()));
    }
    folds.push_back(watch.elapsed_ms());
    watch = CpuWatch();
    const CodeImage code = need(stages.decoder.begin_finish());
    range = need(stages.triangulator.begin(code));
    double df = watch.elapsed_ms(), dr = 0;
    for (int r = 0; r < first.rows; r += 8) {
      const int end = std::min(r + 8, first.rows);
      watch = CpuWatch();
      stages.decoder.finish_rows(r, end);
      df += watch.elapsed_ms();
      watch = CpuWatch();
      stages.triangulator.measure_rows(r, end);
      dr += watch.elapsed_ms();
    }
    finishes.push_back(df);
    ranges.push_back(dr);
  }
  return {median(copies), median(folds), median(finishes), median(ranges)};
}

struct Noise {
  int points = 0;
  int wrong = 0;  // off by more than 1 mm
  double rms_mm = 0.0;
};

// Mean over the measured pixels of a square of 31 around (row, col), from summed-area tables.
class LowPass {
 public:
  LowPass(const std::vector<double>& values, const std::vector<int>& valid, int rows, int cols)
      : rows_(rows), cols_(cols), sum_(table(values)), count_(table(std::vector<double>(valid.begin(), valid.end()))) {}

  [[nodiscard]] double at(int row, int col) const { return box(sum_, row, col) / box(count_, row, col); }

 private:
  [[nodiscard]] std::vector<double> table(const std::vector<double>& values) const {
    std::vector<double> summed(static_cast<std::size_t>((rows_ + 1) * (cols_ + 1)), 0.0);
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < cols_; ++c) {
        summed[index(r + 1, c + 1)] = values[static_cast<std::size_t>(r * cols_ + c)] + summed[index(r, c + 1)] +
                                      summed[index(r + 1, c)] - summed[index(r, c)];
      }
    }
    return summed;
  }
  [[nodiscard]] std::size_t index(int row, int col) const { return static_cast<std::size_t>(row * (cols_ + 1) + col); }
  [[nodiscard]] double box(const std::vector<double>& summed, int row, int col) const {
    constexpr int kReach = 15;
    const int r0 = std::max(row - kReach, 0);
    const int r1 = std::min(row + kReach + 1, rows_);
    const int c0 = std::max(col - kReach, 0);
    const int c1 = std::min(col + kReach + 1, cols_);
    return summed[index(r1, c1)] - summed[index(r0, c1)] - summed[index(r1, c0)] + summed[index(r0, c0)];
  }

  int rows_, cols_;
  std::vector<double> sum_, count_;
};

Noise judge(const RangeImage& range, const std::vector<float>& truth_mm) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  std::vector<double> off(range.point_mm.size(), 0.0);
  std::vector<int> valid(range.point_mm.size(), 0);
  Noise noise;
  for (std::size_t i = 0; i < off.size(); ++i) {
    const float truth = truth_mm[3 * i + 2];
    if (range.point_mm.data[i].z() == 0.0F || !(truth > 0.0F)) continue;
    off[i] = range.point_mm.data[i].z() - truth;
    valid[i] = 1;
    ++noise.points;
    noise.wrong += std::abs(off[i]) > 1.0 ? 1 : 0;
  }
  const LowPass low_pass(off, valid, rows, cols);
  double squares = 0.0;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const auto i = static_cast<std::size_t>(r * cols + c);
      if (valid[i] != 0) squares += std::pow(off[i] - low_pass.at(r, c), 2);
    }
  }
  noise.rms_mm = std::sqrt(squares / std::max(noise.points, 1));
  return noise;
}

void print(const Loaded& loaded, const Times& times, const Noise& noise) {
  const double decode_ms = times.fold_ms + times.finish_ms;
  std::printf("%zu frames of %dx%d\n", loaded.frames.size(), loaded.frames.front().cols, loaded.frames.front().rows);
  std::printf("  memcpy of the frames   %8.2f ms\n", times.memcpy_ms);
  std::printf("  fold                   %8.2f ms   %.2f x memcpy\n", times.fold_ms, times.fold_ms / times.memcpy_ms);
  std::printf("  fold + finish          %8.2f ms   %.2f x memcpy\n", decode_ms, decode_ms / times.memcpy_ms);
  std::printf("  range                  %8.2f ms\n", times.range_ms);
  std::printf("  points                 %8d      (target 1,150,000)\n", noise.points);
  std::printf("  noise RMS              %8.4f mm   (target 0.05)\n", noise.rms_mm);
  std::printf("  off by more than 1 mm  %8d\n", noise.wrong);
  std::printf(
      "{\"frames\": %zu, \"memcpy_ms\": %.3f, \"fold_ms\": %.3f, \"finish_ms\": %.3f, \"range_ms\": %.3f, "
      "\"fold_over_memcpy\": %.3f, \"decode_over_memcpy\": %.3f, \"points\": %d, \"noise_rms_mm\": %.5f, "
      "\"off_over_1mm\": %d}\n",
      loaded.frames.size(), times.memcpy_ms, times.fold_ms, times.finish_ms, times.range_ms,
      times.fold_ms / times.memcpy_ms, decode_ms / times.memcpy_ms, noise.points, noise.rms_mm, noise.wrong);
}

void run(const std::filesystem::path& folder) {
  const Loaded loaded = load(folder);
  if (loaded.frames.front().bits != 8) need(Result<void>(failure(ResultCode{}, "expected 8-bit frames")));
  const auto plan = need(decode::make_fold_plan(loaded.header.sequence));
  const auto limits = decode::limits_for(plan, loaded.frames.front().rows, loaded.frames.front().cols, 1);
  Arena measuring;
  { const Stages stages(measuring, limits); }
  const ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  Stages stages(arena, limits);
  need(stages.triangulator.load(loaded.calibration));
  RangeImage range;
  const Times times = time_passes(loaded, plan, stages, range);
  print(loaded, times, judge(range, loaded.truth_mm));
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  const std::string argument = argc > 1 ? argv[1] : "1";
  if (std::filesystem::exists(argument)) {
    beltpick::bench::run(argument);
    return 0;
  }
  const beltpick::test::TempFolder temp;
  const std::string capture = (temp / "plane").string();
  const std::string command = std::string(BELTPICK_BIN_DIR) + "/beltpick simulate --scene plane --seed " + argument +
                              " --out " + capture + " >&2";
  if (argument.find_first_not_of("0123456789") != std::string::npos || std::system(command.c_str()) != 0) {
    std::fprintf(stderr, "bench_decode: expected a seed or a capture with calibration and truth, found %s\n", argv[1]);
    return 1;
  }
  beltpick::bench::run(capture);
  return 0;
}
