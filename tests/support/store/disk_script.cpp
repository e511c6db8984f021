#include "support/store/disk_script.hpp"

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <utility>

// The linker's --wrap sends a call of X to __wrap_X, and __real_X is the operating system's.
extern "C" {
int __real_openat(int folder, const char* name, int flags, ...);
int __real_mkdir(const char* name, mode_t mode);
int __real_mkdirat(int folder, const char* name, mode_t mode);
ssize_t __real_write(int fd, const void* bytes, size_t size);
int __real_fsync(int fd);
int __real_renameat(int from_folder, const char* from, int to_folder, const char* to);
int __real_unlinkat(int folder, const char* name, int flags);
}

namespace beltpick::test {
namespace {

struct Running {
  bool active = false;
  DiskScript script;
  int calls = 0;
  std::vector<DiskCall> log;
};

Running& running() {
  static Running state;
  return state;
}

std::filesystem::path path_of(int fd) { return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd)); }

std::filesystem::path path_in(int folder, const char* name) { return path_of(folder) / name; }

// Runs `call` as the script has it; `log` is what it is when it succeeds.
template <class Call>
auto scripted(DiskCall log, const Call& call) -> decltype(call()) {
  Running& state = running();
  const int number = state.calls++;
  const DiskEvent event = number >= state.script.at ? state.script.event : DiskEvent::kNone;
  const bool here = number == state.script.at;
  if (here && (event == DiskEvent::kDieBefore || event == DiskEvent::kTear)) (void)raise(SIGKILL);
  if ((here && event == DiskEvent::kFail) || event == DiskEvent::kFailOnward) {
    errno = state.script.error;
    return -1;
  }
  const auto result = call();
  if (here && event == DiskEvent::kDieAfter) (void)raise(SIGKILL);
  const int error = errno;
  if (result >= 0) state.log.push_back(std::move(log));
  errno = error;
  return result;
}

ssize_t scripted_write(int fd, const char* bytes, std::size_t size) {
  const Running& state = running();
  const std::size_t torn = std::min(state.script.torn_bytes, size);
  const bool tears = state.calls == state.script.at && state.script.event != DiskEvent::kNone && torn > 0;
  if (tears && state.script.event == DiskEvent::kTear) (void)__real_write(fd, bytes, torn);
  if (tears && state.script.event != DiskEvent::kTear) {
    // A short write is no failure: what comes after it is.
    running().script.at = state.calls + 1;
    running().script.torn_bytes = 0;
    size = torn;
  }
  return scripted({DiskOp::kWrite, path_of(fd), {}, std::string(bytes, size)},
                  [&] { return __real_write(fd, bytes, size); });
}

}  // namespace

void start_disk_script(const DiskScript& script) { running() = {true, script, 0, {}}; }

std::vector<DiskCall> stop_disk_script() { return std::exchange(running(), {}).log; }

}  // namespace beltpick::test

using beltpick::test::DiskOp;
using beltpick::test::path_in;
using beltpick::test::path_of;
using beltpick::test::running;
using beltpick::test::scripted;

extern "C" {

int __wrap_openat(int folder, const char* name, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  const auto call = [&] { return __real_openat(folder, name, flags, mode); };
  if (!running().active || (flags & O_CREAT) == 0) return call();
  return scripted({DiskOp::kCreate, path_in(folder, name), {}, {}}, call);
}

int __wrap_mkdir(const char* name, mode_t mode) {
  const auto call = [&] { return __real_mkdir(name, mode); };
  return running().active ? scripted({DiskOp::kMakeFolder, std::filesystem::absolute(name), {}, {}}, call) : call();
}

int __wrap_mkdirat(int folder, const char* name, mode_t mode) {
  const auto call = [&] { return __real_mkdirat(folder, name, mode); };
  return running().active ? scripted({DiskOp::kMakeFolder, path_in(folder, name), {}, {}}, call) : call();
}

ssize_t __wrap_write(int fd, const void* bytes, size_t size) {
  if (!running().active) return __real_write(fd, bytes, size);
  return beltpick::test::scripted_write(fd, static_cast<const char*>(bytes), size);
}

int __wrap_fsync(int fd) {
  const auto call = [&] { return __real_fsync(fd); };
  return running().active ? scripted({DiskOp::kSync, path_of(fd), {}, {}}, call) : call();
}

int __wrap_renameat(int from_folder, const char* from, int to_folder, const char* to) {
  const auto call = [&] { return __real_renameat(from_folder, from, to_folder, to); };
  if (!running().active) return call();
  return scripted({DiskOp::kRename, path_in(from_folder, from), path_in(to_folder, to), {}}, call);
}

int __wrap_unlinkat(int folder, const char* name, int flags) {
  const auto call = [&] { return __real_unlinkat(folder, name, flags); };
  return running().active ? scripted({DiskOp::kRemove, path_in(folder, name), {}, {}}, call) : call();
}

}  // extern "C"
