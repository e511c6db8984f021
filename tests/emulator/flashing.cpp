#include "emulator/flashing.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

namespace emulator {

Flashing::Flashing(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {BELTPICK_BIN_DIR "/beltpick", "flash"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string out = (folder_ / "out").string();
  const std::string err = (folder_ / "err").string();
  pid_ = ::fork();
  ::setpgid(pid_, pid_);  // whichever of the two comes first
  if (pid_ != 0) return;
  ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
  ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
  ::execv(pointers[0], pointers.data());
  ::_exit(127);
}

Flashing::~Flashing() {
  kill_all();
  outcome();
}

bool Flashing::runs() {
  if (!ended_) ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
  return !ended_;
}

void Flashing::kill_all() {
  if (runs()) ::kill(-pid_, SIGKILL);
}

void Flashing::kill_avrdude() {
  const std::string pid = std::to_string(pid_);
  std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
  for (pid_t child = 0; children >> child;) ::kill(child, SIGKILL);
}

beltpick::test::Outcome Flashing::outcome() {
  if (!ended_) ended_ = ::waitpid(pid_, &status_, 0) == pid_;
  beltpick::test::Outcome outcome;
  outcome.exit_code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  outcome.out = beltpick::test::file_bytes(folder_ / "out");
  outcome.err = beltpick::test::file_bytes(folder_ / "err");
  return outcome;
}

}  // namespace emulator
