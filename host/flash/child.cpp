#include "flash/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "contract/result_codes.hpp"

namespace beltpick::flash {

namespace {

[[noreturn]] void become(const std::string& path, const std::vector<std::string>& command, int output) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::execv(path.c_str(), arguments.data());
  ::_exit(127);
}

void read_output(int fd, pid_t child, int patience_ms, const std::function<void(std::string_view)>& take) {
  char bytes[512];
  while (true) {
    pollfd wait{fd, POLLIN, 0};
    if (::poll(&wait, 1, patience_ms) == 0) ::kill(child, SIGTERM);
    const ssize_t count = ::read(fd, bytes, sizeof bytes);
    if (count == 0 || (count < 0 && errno != EINTR)) return;
    if (count > 0) take({bytes, static_cast<std::size_t>(count)});
  }
}

}  // namespace

std::string find_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "";
  for (std::size_t from = 0; from <= folders.size();) {
    const std::size_t to = std::min(folders.find(':', from), folders.size());
    const std::string candidate = folders.substr(from, to - from) + "/" + program;
    if (to > from && ::access(candidate.c_str(), X_OK) == 0) return candidate;
    from = to + 1;
  }
  return "";
}

Result<int> run_child(const std::string& path, const std::vector<std::string>& command, int patience_ms,
                      const std::function<void(std::string_view)>& take) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) return failure(ResultCode::kInternal, "pipe: %s", std::strerror(errno));
  const pid_t child = ::fork();
  if (child == 0) become(path, command, pipe[1]);
  const int fork_error = errno;
  ::close(pipe[1]);
  if (child < 0) {
    ::close(pipe[0]);
    return failure(ResultCode::kInternal, "fork: %s", std::strerror(fork_error));
  }
  read_output(pipe[0], child, patience_ms, take);
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace beltpick::flash
