// RunBook: what happened since start, counted in fixed memory by threads that may not allocate; the summary of a run.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/arena.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/locate_result.hpp"

namespace beltpick::app {

// What a capture's time is spent on, as the summary names it.
enum class Step : std::uint8_t { kCapture, kFold, kDecode, kRange, kSegment, kLocate, kLocatePart, kLastFrameToPoses };
inline constexpr std::size_t kSteps = 8;
const char* step_name(Step step);

class RunBook {
 public:
  void add_cycle();
  void add_capture(bool failed);
  // What the latest capture of this view showed; of the views of one cycle only the last one's withheld objects count,
  // when the belt takes them away.
  void set_view(int found, std::span<const WithheldObject> withheld);
  // How the pixels of the latest capture were measured, or why not.
  void set_pixels(const PixelCounts& pixels);
  // How much nearer than the cell file has it the belt was measured of late, mm; nothing where that is not known.
  void set_belt_nearer(std::optional<double> nearer_mm);
  void add_release();
  void add_offer();
  void add_answer(bool picked);
  void add_fault(ResultCode code);
  void add_time(Step step, double ms);

  struct Counts {
    int cycles = 0, captures = 0, offers = 0, picked = 0, faults = 0;
  };
  [[nodiscard]] Counts counts() const;
  // All zero before the first capture.
  [[nodiscard]] PixelCounts pixels() const;
  [[nodiscard]] std::optional<double> belt_nearer_mm() const;

  // For a thread that may allocate.
  struct Count {
    ResultCode code{};
    int count = 0;
  };
  struct Totals {
    int cycles = 0, captures = 0, failed_captures = 0, found = 0, offers = 0, picked = 0, failed_picks = 0;
    std::vector<Count> withheld, faults;
    std::array<double, kSteps> median_ms{};  // 0 where nothing was measured
  };
  [[nodiscard]] Totals totals() const;

 private:
  static constexpr std::size_t kSamples = 4096;  // the latest of each step
  static constexpr std::size_t kCodes = 32;
  struct Codes {
    std::array<Count, kCodes> entries{};
    std::size_t used = 0;
    void add(ResultCode code, int count = 1);
    [[nodiscard]] std::vector<Count> list() const {
      return {entries.begin(), entries.begin() + static_cast<long>(used)};
    }
  };

  mutable std::mutex mutex_;
  int cycles_ = 0, captures_ = 0, failed_captures_ = 0, found_ = 0, offers_ = 0, picked_ = 0, failed_picks_ = 0;
  PixelCounts pixels_{};
  std::optional<double> belt_nearer_mm_;
  Codes view_withheld_, withheld_, faults_;
  std::array<std::array<float, kSamples>, kSteps> samples_{};
  std::array<std::size_t, kSteps> sample_count_{};
};

// Resident memory of this process in MB, now and at its highest; 0 where the system does not tell.
double resident_mb();
double peak_resident_mb();

// {"cycles", "captures", ..., "stage_ms": {...}, "rss_mb", "budget": {"total_mb", "shares": {...}}, "withheld": {...}}
// as one line of JSON.
std::string summary_text(const RunBook& book, std::span<const Arena::Share> budget);
Result<void> write_summary(const std::filesystem::path& path, const RunBook& book,
                           std::span<const Arena::Share> budget);

}  // namespace beltpick::app
