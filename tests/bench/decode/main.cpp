// What decoding and triangulation cost beside a memcpy of the same frames, and what noise comes out:
//   bench_decode [SEED]       simulates 22 frames of a plane with that seed (default 1)
//   bench_decode CAPTURE      a folder of `beltpick simulate`, of any sequence
// Prints a table and, as its last line, JSON. Times are this thread's own, medians over passes each of which does
// everything: compare the ratios. Besides: the kernels as built for the baseline processor (bench_decode_plain), the
// same job by OpenCV's vectorised calls, and OpenCV's own Gray decoder on a real capture, where ../shared/data or
// BELTPICK_REAL_DATA has procam-gray.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "bench/decode/checksum.hpp"
#include "bench/decode/job.hpp"
#include "bench/decode/noise.hpp"
#include "bench/decode/opencv_gray.hpp"
#include "bench/decode/opencv_job.hpp"
#include "contract_io/npy_io.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::bench {
namespace {

constexpr int kPasses = 31;
constexpr int kSlowPasses = 5;
constexpr int kAllRows = 0;

// White, black, 12 phase steps and 8 Gray bits.
std::string sequence_of_22() {
  std::string frames;
  int number = 0;
  const auto add = [&](const std::string& members) {
    char file[32];
    std::snprintf(file, sizeof file, "%s{\"file\": \"%03d.png\", ", number == 0 ? "" : ", ", number);
    ++number;
    frames += file + members + "}";
  };
  add("\"kind\": \"white\"");
  add("\"kind\": \"black\"");
  for (int step = 0; step < 12; ++step) {
    add("\"kind\": \"phase\", \"axis\": \"column\", \"period_px\": 16, \"steps\": 12, \"step\": " +
        std::to_string(step));
  }
  for (int bit = 7; bit >= 0; --bit) {
    add("\"kind\": \"gray\", \"axis\": \"column\", \"cell_px\": 8, \"bit\": " + std::to_string(bit));
  }
  return R"({"format": "beltpick-capture", "version": 1, "projector": {"width": 912, "height": 1140}, "frames": [)" +
         frames + "]}";
}

void simulate(const std::string& seed, const test::TempFolder& temp, const std::string& capture) {
  const std::string sequence = temp.file("sequence.json", sequence_of_22()).string();
  const std::string command = std::string(BELTPICK_BIN_DIR) + "/beltpick simulate --scene plane --seed " + seed +
                              " --sequence " + sequence + " --out " + capture + " >&2";
  if (std::system(command.c_str()) != 0) give_up("the virtual cell failed");
}

struct Plain {
  double memcpy_ms = 0.0, fold_ms = 0.0, finish_ms = 0.0;
  unsigned long long checksum = 0;
};

Plain time_plain(const std::string& capture) {
  const std::string command =
      std::string(BELTPICK_BENCH_DIR) + "/bench_decode_plain '" + capture + "' " + std::to_string(kPasses);
  Plain plain;
  FILE* out = popen(command.c_str(), "r");
  if (out == nullptr) give_up("bench_decode_plain does not start");
  const int read =
      std::fscanf(out, "%lf %lf %lf %llx", &plain.memcpy_ms, &plain.fold_ms, &plain.finish_ms, &plain.checksum);
  if (pclose(out) != 0 || read != 4) give_up("bench_decode_plain failed");
  return plain;
}

struct Line {
  std::string json;

  void add(const char* name, double value) {
    char text[96];
    std::snprintf(text, sizeof text, "%s\"%s\": %.6g", json.empty() ? "{" : ", ", name, value);
    json += text;
  }
};

void print_row(const char* what, double ms, double memcpy_ms) {
  std::printf("  %-34s %8.3f ms  %6.2f x memcpy\n", what, ms, ms / memcpy_ms);
}

void report_times(const Loaded& loaded, const Job& job, const Times& times, Line& line) {
  const auto frames = static_cast<double>(loaded.frames.size());
  const int state_bytes = job.plan().state_bytes(1);
  std::printf("%zu frames of %dx%d, %d bytes of state a pixel, %.1f MB in all\n", loaded.frames.size(), loaded.cols(),
              loaded.rows(), state_bytes, 1e-6 * static_cast<double>(job.memory_bytes()));
  print_row("memcpy of the frames", times.memcpy_ms, times.memcpy_ms);
  print_row("fold", times.fold_ms, times.memcpy_ms);
  std::printf("    a frame %.3f ms, the slowest %.3f ms\n", times.fold_ms / frames, times.slowest_frame_ms);
  print_row("finish", times.finish_ms, times.memcpy_ms);
  print_row("  are the frames the sequence's?", times.judge_ms, times.memcpy_ms);
  print_row("  phase, order, mask", times.decode_ms, times.memcpy_ms);
  print_row("  points, sigma, edges", times.range_ms, times.memcpy_ms);
  line.add("frames", frames);
  line.add("state_bytes_px", state_bytes);
  line.add("memory_mb", 1e-6 * static_cast<double>(job.memory_bytes()));
  line.add("memcpy_ms", times.memcpy_ms);
  line.add("fold_ms", times.fold_ms);
  line.add("fold_frame_ms", times.fold_ms / frames);
  line.add("fold_slowest_frame_ms", times.slowest_frame_ms);
  line.add("judge_ms", times.judge_ms);
  line.add("decode_ms", times.decode_ms);
  line.add("range_ms", times.range_ms);
  line.add("fold_over_memcpy", times.fold_ms / times.memcpy_ms);
  line.add("finish_over_memcpy", times.finish_ms / times.memcpy_ms);
}

void report_plain(const std::string& capture, const Job& job, Line& line) {
  const Plain plain = time_plain(capture);
  const bool same = plain.checksum == checksum(job.range());
  std::printf("plain build (no run-time choice of vector units): points %s\n",
              same ? "the same to the bit" : "DIFFER from the dispatched build's");
  print_row("fold", plain.fold_ms, plain.memcpy_ms);
  print_row("finish", plain.finish_ms, plain.memcpy_ms);
  line.add("plain_fold_over_memcpy", plain.fold_ms / plain.memcpy_ms);
  line.add("plain_finish_over_memcpy", plain.finish_ms / plain.memcpy_ms);
  line.add("plain_same_bits", same ? 1.0 : 0.0);
}

// What opencv_job.hpp knows: one period of column fringes, one Gray code without twins, white and black.
bool fits_opencv(const decode::FoldPlan& plan) {
  return plan.exposures.size() == 1 && plan.channels.size() == 1 && plan.grays.size() == 1 &&
         plan.codes(Axis::kColumn) && !plan.codes(Axis::kRow) && plan.grays.front().bits.size() <= 8 &&
         std::all_of(plan.grays.front().bits.begin(), plan.grays.front().bits.end(), [](const decode::GrayBit& bit) {
           return bit.frame != decode::kNone && bit.threshold.kind == decode::ThresholdKind::kMidpoint;
         });
}

void report_opencv(const Loaded& loaded, const Calibration& calibration, const Job& job, const Times& times,
                   Line& line) {
  if (!fits_opencv(job.plan())) {
    std::printf("by OpenCV's calls: not for this sequence (one period, one Gray code, white and black)\n");
    return;
  }
  Job whole(loaded, &calibration, kAllRows);  // for its codes
  whole.time(1);
  const OpencvTimes opencv = time_opencv(loaded, calibration, whole, kSlowPasses);
  const double ours_ms = times.fold_ms + times.finish_ms;
  std::printf(
      "by OpenCV's vectorised calls        %8.1f ms  %6.1f x fold and finish; of the points %.3f %% in both, codes "
      "within "
      "%.4f px, depths within %.4f mm\n",
      opencv.ms, opencv.ms / ours_ms, 100.0 * opencv.share_both, opencv.worst_code_px, opencv.worst_depth_mm);
  line.add("opencv_ms", opencv.ms);
  line.add("opencv_over_ours", opencv.ms / ours_ms);
  line.add("opencv_code_difference_px", opencv.worst_code_px);
  line.add("opencv_depth_difference_mm", opencv.worst_depth_mm);
}

void report_gray(Line& line) {
  const char* given = std::getenv("BELTPICK_REAL_DATA");
  const std::filesystem::path root =
      given != nullptr ? std::filesystem::path(given) : std::filesystem::path(BELTPICK_SOURCE_DIR) / "../shared/data";
  const std::filesystem::path capture = root / "procam-gray" / "capture_0";
  if (!std::filesystem::exists(capture)) {
    std::printf("OpenCV's Gray decoder: no %s; set BELTPICK_REAL_DATA\n", capture.c_str());
    return;
  }
  const Loaded loaded = load_frames(capture);
  Job job(loaded, nullptr, kAllRows);
  const Times times = job.time(kPasses);
  const GrayTimes gray = time_opencv_gray(loaded, job, kSlowPasses);
  const double ours_ms = times.fold_ms + times.finish_ms;
  std::printf("procam-gray, %zu frames of %dx%d, both axes, %d bytes of state a pixel\n", loaded.frames.size(),
              loaded.cols(), loaded.rows(), job.plan().state_bytes(1));
  print_row("fold", times.fold_ms, times.memcpy_ms);
  print_row("fold and finish", ours_ms, times.memcpy_ms);
  std::printf("OpenCV's Gray decoder               %8.1f ms  %6.1f x fold and finish; %d of %d pixels differ\n",
              gray.opencv_ms, gray.opencv_ms / ours_ms, gray.different, gray.compared);
  line.add("gray_ms", ours_ms);
  line.add("gray_fold_over_memcpy", times.fold_ms / times.memcpy_ms);
  line.add("opencv_gray_ms", gray.opencv_ms);
  line.add("opencv_gray_over_ours", gray.opencv_ms / ours_ms);
  line.add("opencv_gray_compared", gray.compared);
  line.add("opencv_gray_different", gray.different);
}

void report_noise(const std::string& capture, const Job& job, Line& line) {
  const std::filesystem::path truth = std::filesystem::path(capture) / "truth_xyz.npy";
  if (!std::filesystem::exists(truth)) return;
  const Noise noise = judge_noise(job.range(), need(contract_io::read_npy<float>(truth, {-1, -1, 3})).values);
  std::printf(
      "%d points (%.2f %% of those seen), local noise %.4f mm RMS, %.3f of what the noise law predicts, %d off by "
      "more than 1 mm\n",
      noise.points, 100.0 * noise.valid_share, noise.rms_mm, noise.rms_mm / noise.predicted_mm, noise.wrong);
  line.add("noise_predicted_mm", noise.predicted_mm);
  line.add("valid_share", noise.valid_share);
  line.add("points", noise.points);
  line.add("noise_rms_mm", noise.rms_mm);
  line.add("off_over_1mm", noise.wrong);
}

void run(const std::string& capture) {
  const Loaded loaded = load_frames(capture);
  const Calibration calibration = load_calibration(capture);
  Job job(loaded, &calibration, decode::kBandRows);
  Line line;
  const Times times = job.time(kPasses);
  report_times(loaded, job, times, line);
  report_plain(capture, job, line);
  report_opencv(loaded, calibration, job, times, line);
  report_gray(line);
  report_noise(capture, job, line);
  std::printf("%s}\n", line.json.c_str());
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  using namespace beltpick::bench;
  const std::string argument = argc > 1 ? argv[1] : "1";
  if (std::filesystem::exists(argument)) {
    run(argument);
    return 0;
  }
  if (argument.find_first_not_of("0123456789") != std::string::npos) {
    give_up(("expected a seed or a capture with its calibration, found " + argument).c_str());
  }
  const beltpick::test::TempFolder temp;
  const std::string capture = (temp / "plane").string();
  simulate(argument, temp, capture);
  run(capture);
  return 0;
}
