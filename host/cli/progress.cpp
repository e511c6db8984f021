#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace beltpick::cli {
namespace {

constexpr double kPatienceMs = 1000.0;
constexpr double kRedrawMs = 100.0;
constexpr int kBarWidth = 40;

}  // namespace

Progress::Progress(std::string what, int total, bool quiet)
    : what_(std::move(what)), total_(std::max(total, 1)), silent_(quiet || isatty(STDERR_FILENO) == 0) {}

Progress::~Progress() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
}

void Progress::show(int done) {
  const double now_ms = watch_.elapsed_ms();
  if (silent_ || now_ms < kPatienceMs || now_ms - last_ms_ < kRedrawMs) return;
  last_ms_ = now_ms;
  drawn_ = true;
  const int filled = std::clamp(done * kBarWidth / total_, 0, kBarWidth);
  std::fprintf(stderr, "\r%s [%.*s%*s] %d/%d", what_.c_str(), filled, "########################################",
               kBarWidth - filled, "", done, total_);
  std::fflush(stderr);
}

}  // namespace beltpick::cli
