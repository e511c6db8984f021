#include "flash/avrdude.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "flash/child.hpp"

namespace beltpick::flash {

namespace {

constexpr int kMarksPerPhase = 50;
// avrdude shows its progress many times a second; a line that it has lost it gives up after half a minute only. An
// in-system programmer may erase and read back without a word.
constexpr int kPatienceOfLineMs = 8'000;
constexpr int kPatienceInSystemMs = 60'000;
constexpr int kEndedBySigterm = 128 + 15;
constexpr std::string_view kWriting = "Writing |";
constexpr std::string_view kReading = "Reading |";

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

int AvrdudeProgress::take(std::string_view output) {
  for (const char c : output) {
    if (c == '#') marks_ = std::min(marks_ + 1, kMarksPerPhase);
    tail_ += c;
    if (tail_.size() > kWriting.size()) tail_.erase(0, 1);
    const bool writes = ends_with(tail_, kWriting);
    if (!writes && !(phase_ == Phase::kWriting && ends_with(tail_, kReading))) continue;
    phase_ = writes ? Phase::kWriting : Phase::kReading;
    marks_ = 0;
  }
  if (phase_ == Phase::kBefore) return 0;
  return phase_ == Phase::kWriting ? marks_ : kMarksPerPhase + marks_;
}

// The first error line tells the cause; that a tty has no modem lines is none.
std::string avrdude_complaint(const std::string& output) {
  constexpr std::string_view kMark = " error: ";
  for (std::size_t from = 0; from < output.size();) {
    const std::size_t to = std::min(output.find('\n', from), output.size());
    const std::string line = output.substr(from, to - from);
    from = to + 1;
    const std::size_t at = line.find(kMark);
    if (at == std::string::npos || line.find("TIOCM") != std::string::npos) continue;
    return contract_io::one_line(line.substr(at + kMark.size()));
  }
  return "";
}

Result<std::string> find_avrdude() {
  std::string path = find_in_path("avrdude");
  if (!path.empty()) return path;
  return failure(ResultCode::kFileNotFound,
                 "avrdude: expected the program in PATH, found none; install it: sudo apt-get install avrdude");
}

Result<void> run_avrdude(const AvrdudeJob& job, const std::function<void(int)>& percent) {
  const auto path = find_avrdude();
  if (!path) return std::unexpected(path.error());
  const int patience_ms = job.way == Way::kInSystem ? kPatienceInSystemMs : kPatienceOfLineMs;
  AvrdudeProgress progress;
  std::string output;
  const auto code = run_child(*path, avrdude_command(job), patience_ms, [&](std::string_view bytes) {
    output += bytes;
    percent(progress.take(bytes));
  });
  if (!code) return std::unexpected(code.error());
  if (*code == 0) return {};
  std::string complaint = avrdude_complaint(output);
  if (complaint.empty() && *code == kEndedBySigterm) complaint = "the board fell silent";
  if (complaint.empty()) complaint = "exit code " + std::to_string(*code);
  return failure(ResultCode::kUpdateFailed, "avrdude: %s", complaint.c_str());
}

}  // namespace beltpick::flash
