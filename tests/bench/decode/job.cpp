#include "bench/decode/job.hpp"

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "decode/decoder.hpp"
#include "range/triangulator.hpp"

namespace beltpick::bench {
namespace {

decode::DecoderLimits limits_of(const decode::FoldPlan& plan, const Loaded& loaded, int band_rows) {
  decode::DecoderLimits limits = decode::limits_for(plan, loaded.rows(), loaded.cols(), 1);
  limits.band_rows = band_rows;
  return limits;
}

}  // namespace

void give_up(const char* what) {
  std::fprintf(stderr, "bench_decode: %s\n", what);
  std::exit(1);
}

Loaded load_frames(const std::filesystem::path& capture) {
  contract_io::Warnings warnings;
  auto reader = need(contract_io::CaptureReader::open(capture, warnings));
  Loaded loaded{reader.header(), {}};
  for (int i = 0; i < reader.frames(); ++i) loaded.frames.push_back(need(reader.image(i, warnings)));
  if (loaded.frames.front().bits != 8) give_up("expected a capture of 8-bit frames");
  return loaded;
}

Calibration load_calibration(const std::filesystem::path& capture) {
  contract_io::Warnings warnings;
  return need(contract_io::read_calibration(capture / "calibration.json", warnings));
}

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Job::Stages {
  struct Both {
    decode::Decoder decoder;
    range::Triangulator triangulator;
    Both(Arena& arena, const decode::DecoderLimits& limits)
        : decoder(arena, limits), triangulator(arena, limits.rows, limits.cols) {}
  };
  static std::size_t bytes_for(const decode::DecoderLimits& limits) {
    Arena measuring;
    const Both both(measuring, limits);
    return measuring.used_bytes();
  }
  Stages(const decode::FoldPlan& plan_, const decode::DecoderLimits& limits)
      : plan(plan_), block(bytes_for(limits)), arena(block.data(), block.bytes()), both(arena, limits) {}

  decode::FoldPlan plan;
  ArenaBlock block;
  Arena arena;
  Both both;
  bool triangulates = false;
  std::vector<std::uint8_t> copy;
  CodeImage code;
  RangeImage range;
};

Job::Job(const Loaded& loaded, const Calibration* calibration, int band_rows) : loaded_(loaded) {
  const auto plan = need(decode::make_fold_plan(loaded.header.sequence));
  stages_ = std::make_unique<Stages>(plan, limits_of(plan, loaded, band_rows));
  stages_->copy.resize(loaded.frames.size() * loaded.frames.front().pixels8.size());
  stages_->triangulates = calibration != nullptr;
  if (calibration != nullptr) need(stages_->both.triangulator.load(*calibration));
}
Job::~Job() = default;

const CodeImage& Job::code() const { return stages_->code; }
const RangeImage& Job::range() const { return stages_->range; }
const decode::FoldPlan& Job::plan() const { return stages_->plan; }
std::size_t Job::memory_bytes() const { return stages_->block.bytes(); }

void Job::fold_all(double& total_ms, double& slowest_ms) {
  decode::Decoder& decoder = stages_->both.decoder;
  need(decoder.begin(stages_->plan, loaded_.rows(), loaded_.cols(), 1, loaded_.header.full_scale));
  total_ms = slowest_ms = 0.0;
  for (std::size_t i = 0; i < loaded_.frames.size(); ++i) {
    const double start_ms = thread_ms();
    need(decoder.fold(static_cast<int>(i), loaded_.frames[i].view8()));
    const double ms = thread_ms() - start_ms;
    total_ms += ms;
    slowest_ms = std::max(slowest_ms, ms);
  }
}

// `between` is called after begin_finish() and after each stage of a band.
template <class Between>
void Job::finish_all(Between between) {
  Stages::Both& both = stages_->both;
  stages_->code = need(both.decoder.begin_finish());
  if (stages_->triangulates) stages_->range = need(both.triangulator.begin(stages_->code));
  between(&Times::judge_ms);
  for (int first = 0; first < loaded_.rows(); first += decode::kBandRows) {
    const CodeImage band = both.decoder.finish_rows(first, std::min(first + decode::kBandRows, loaded_.rows()));
    between(&Times::decode_ms);
    if (stages_->triangulates) both.triangulator.measure_rows(band, first);
    between(&Times::range_ms);
  }
}

Times Job::time_once() {
  Times times;
  const std::size_t frame_bytes = loaded_.frames.front().pixels8.size();
  const double start_ms = thread_ms();
  for (std::size_t i = 0; i < loaded_.frames.size(); ++i) {
    std::memcpy(&stages_->copy[i * frame_bytes], loaded_.frames[i].pixels8.data(), frame_bytes);
  }
  times.memcpy_ms = thread_ms() - start_ms;
  fold_all(times.fold_ms, times.slowest_frame_ms);
  const double folded_ms = thread_ms();
  finish_all([](auto) {});
  double last_ms = thread_ms();
  times.finish_ms = last_ms - folded_ms;
  // Once more for its stages: to read the clock so often takes time itself.
  finish_all([&](double Times::*stage) {
    const double now_ms = thread_ms();
    times.*stage += now_ms - last_ms;
    last_ms = now_ms;
  });
  return times;
}

Times Job::time(int passes) {
  std::vector<Times> all(static_cast<std::size_t>(passes));
  for (Times& times : all) times = time_once();
  Times middle;
  for (double Times::*stage : {&Times::memcpy_ms, &Times::fold_ms, &Times::slowest_frame_ms, &Times::finish_ms,
                               &Times::judge_ms, &Times::decode_ms, &Times::range_ms}) {
    std::vector<double> values;
    for (const Times& times : all) values.push_back(times.*stage);
    middle.*stage = median(values);
  }
  return middle;
}

}  // namespace beltpick::bench
