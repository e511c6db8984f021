#include "terminal.hpp"

#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace beltpick::cli {
namespace {

// Typed characters are not shown while it lives.
class NoEcho {
 public:
  NoEcho() {
    if (tcgetattr(STDIN_FILENO, &before_) != 0) return;
    termios silent = before_;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    changed_ = tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent) == 0;
  }
  ~NoEcho() {
    if (changed_) tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
  }
  NoEcho(const NoEcho&) = delete;
  NoEcho& operator=(const NoEcho&) = delete;

 private:
  termios before_{};
  bool changed_ = false;
};

std::optional<std::string> read_line() {
  std::string line;
  if (!std::getline(std::cin, line)) return std::nullopt;
  return line;
}

}  // namespace

bool is_interactive() { return isatty(STDIN_FILENO) == 1 && isatty(STDERR_FILENO) == 1; }

std::optional<std::string> read_secret(const std::string& prompt) {
  if (!is_interactive()) return read_line();
  std::fputs(prompt.c_str(), stderr);
  const NoEcho silence;
  auto line = read_line();
  std::fputc('\n', stderr);
  return line;
}

bool confirm(const std::string& question) {
  std::fputs(question.c_str(), stderr);
  const auto answer = read_line();
  return answer == "y" || answer == "yes";
}

}  // namespace beltpick::cli
