// The job that is timed: the frames of a capture folded as they would arrive, then finished to points in mm.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "contract_io/image_io.hpp"
#include "decode/decoder.hpp"

namespace beltpick::bench {

// Ends the program with the error on stderr.
[[noreturn]] void give_up(const char* what);

template <class T>
T need(Result<T> result) {
  if (!result) give_up(result.error().detail);
  return std::move(*result);
}
inline void need(const Result<void>& result) {
  if (!result) give_up(result.error().detail);
}

struct Loaded {
  CaptureHeader header;
  std::vector<contract_io::GreyImage> frames;

  [[nodiscard]] int rows() const { return frames.front().rows; }
  [[nodiscard]] int cols() const { return frames.front().cols; }
};
Loaded load_frames(const std::filesystem::path& capture);
Calibration load_calibration(const std::filesystem::path& capture);

// Time that this thread computed: neighbours on the machine do not count.
double thread_ms();
double median(std::vector<double> values);

// Medians over the passes; every pass does everything, so that all are disturbed alike.
struct Times {
  double memcpy_ms = 0.0;  // of the same frames
  double fold_ms = 0.0;
  double slowest_frame_ms = 0.0;  // to fold; the median pass
  double finish_ms = 0.0;         // all that follows the last frame; its stages, from a second run:
  double judge_ms = 0.0;          // whether the frames are what the sequence says
  double decode_ms = 0.0;         // phase, order, mask, noise
  double range_ms = 0.0;          // points in mm, their sigma, flying pixels masked
};

// A decoder and, with a calibration, a triangulator in fixed memory of their own.
class Job {
 public:
  // Keeps `band_rows` rows of the code image, 0: all; see DecoderLimits.
  Job(const Loaded& loaded, const Calibration* calibration, int band_rows);
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  Times time(int passes);
  // Of the last pass; coordinates and modulation only where all their rows are kept.
  [[nodiscard]] const CodeImage& code() const;
  [[nodiscard]] const RangeImage& range() const;
  [[nodiscard]] const decode::FoldPlan& plan() const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  void fold_all(double& total_ms, double& slowest_ms);
  template <class Between>
  void finish_all(Between between);
  Times time_once();

  struct Stages;
  const Loaded& loaded_;
  std::unique_ptr<Stages> stages_;
};

}  // namespace beltpick::bench
