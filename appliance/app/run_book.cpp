#include "app/run_book.hpp"

#include <algorithm>

namespace beltpick::app {

const char* step_name(Step step) {
  constexpr std::array names{"capture", "fold",   "decode",      "range",
                             "segment", "locate", "locate_part", "last_frame_to_poses"};
  return names[static_cast<std::size_t>(step)];
}

void RunBook::Codes::add(ResultCode code, int count) {
  const auto end = entries.begin() + static_cast<std::ptrdiff_t>(used);
  const auto found = std::find_if(entries.begin(), end, [&](const Count& entry) { return entry.code == code; });
  if (found != end) {
    found->count += count;
  } else if (used < kCodes) {
    entries[used++] = {code, count};
  }
}

void RunBook::add_cycle() {
  const std::lock_guard lock(mutex_);
  ++cycles_;
}

void RunBook::add_capture(bool failed) {
  const std::lock_guard lock(mutex_);
  ++captures_;
  if (failed) ++failed_captures_;
}

void RunBook::set_view(int found, std::span<const WithheldObject> withheld) {
  const std::lock_guard lock(mutex_);
  found_ += found;
  view_withheld_.used = 0;
  for (const WithheldObject& object : withheld) view_withheld_.add(object.reason.code);
}

void RunBook::set_pixels(const PixelCounts& pixels) {
  const std::lock_guard lock(mutex_);
  pixels_ = pixels;
}

void RunBook::set_belt_nearer(std::optional<double> nearer_mm) {
  const std::lock_guard lock(mutex_);
  belt_nearer_mm_ = nearer_mm;
}

void RunBook::add_release() {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < view_withheld_.used; ++i) {
    withheld_.add(view_withheld_.entries[i].code, view_withheld_.entries[i].count);
  }
  view_withheld_.used = 0;
}

void RunBook::add_offer() {
  const std::lock_guard lock(mutex_);
  ++offers_;
}

void RunBook::add_answer(bool picked) {
  const std::lock_guard lock(mutex_);
  ++(picked ? picked_ : failed_picks_);
}

void RunBook::add_fault(ResultCode code) {
  const std::lock_guard lock(mutex_);
  faults_.add(code);
}

void RunBook::add_time(Step step, double ms) {
  const std::lock_guard lock(mutex_);
  const auto at = static_cast<std::size_t>(step);
  samples_[at][sample_count_[at]++ % kSamples] = static_cast<float>(ms);
}

RunBook::Counts RunBook::counts() const {
  const std::lock_guard lock(mutex_);
  Counts out{cycles_, captures_, offers_, picked_, 0};
  for (std::size_t i = 0; i < faults_.used; ++i) out.faults += faults_.entries[i].count;
  return out;
}

PixelCounts RunBook::pixels() const {
  const std::lock_guard lock(mutex_);
  return pixels_;
}

std::optional<double> RunBook::belt_nearer_mm() const {
  const std::lock_guard lock(mutex_);
  return belt_nearer_mm_;
}

RunBook::Totals RunBook::totals() const {
  const std::lock_guard lock(mutex_);
  Totals out{cycles_, captures_,     failed_captures_, found_,         offers_,
             picked_, failed_picks_, withheld_.list(), faults_.list(), {}};
  for (std::size_t step = 0; step < kSteps; ++step) {
    const std::size_t count = std::min(sample_count_[step], kSamples);
    if (count == 0) continue;
    std::vector<float> sorted(samples_[step].begin(), samples_[step].begin() + static_cast<std::ptrdiff_t>(count));
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count / 2), sorted.end());
    out.median_ms[step] = static_cast<double>(sorted[count / 2]);
  }
  return out;
}

}  // namespace beltpick::app
