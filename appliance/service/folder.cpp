#include "service/folder.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <utility>

namespace beltpick::service {
namespace {

constexpr mode_t kFolderMode = 0750;

std::unexpected<int> last_error() { return std::unexpected(errno); }

int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int flush(int fd) { return fsync(fd) == 0 ? 0 : errno; }

// The folder that holds the entry `path`: what must be flushed when the entry is new.
std::filesystem::path holder(const std::filesystem::path& path) {
  const std::filesystem::path parent = path.parent_path();
  return parent.empty() ? std::filesystem::path(".") : parent;
}

int make_one(const std::filesystem::path& path) {
  if (mkdir(path.c_str(), kFolderMode) != 0) return errno == EEXIST ? 0 : errno;
  const Descriptor parent(open(holder(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return parent.open() ? flush(parent.get()) : errno;
}

}  // namespace

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

Descriptor::~Descriptor() {
  if (fd_ >= 0) close(fd_);
}

Folder::Answer<Folder> Folder::make(const std::filesystem::path& path) {
  std::filesystem::path so_far;
  for (const std::filesystem::path& part : path) {
    so_far /= part;
    if (part.empty() || part == "/") continue;
    if (const int error = make_one(so_far); error != 0) return std::unexpected(error);
  }
  return open(path);
}

Folder::Answer<Folder> Folder::open(const std::filesystem::path& path) {
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor.open()) return last_error();
  return Folder(std::move(descriptor));
}

Folder::Answer<Folder> Folder::sub(const std::string& name) const {
  Descriptor descriptor(
      openat(descriptor_.get(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  if (!descriptor.open()) return last_error();
  return Folder(std::move(descriptor));
}

Folder::Answer<Folder> Folder::make_sub(const std::string& name) const {
  if (mkdirat(descriptor_.get(), name.c_str(), kFolderMode) != 0 && errno != EEXIST) return last_error();
  if (const int error = sync(); error != 0) return std::unexpected(error);
  return sub(name);
}

Folder::Answer<std::vector<std::string>> Folder::names() const {
  // A description of its own: two of one folder would share the reading position.
  Descriptor own(openat(descriptor_.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!own.open()) return last_error();
  struct Close {
    void operator()(DIR* stream) const { closedir(stream); }
  };
  const std::unique_ptr<DIR, Close> stream(fdopendir(own.get()));
  if (!stream) return last_error();
  (void)own.release();
  std::vector<std::string> found;
  errno = 0;
  while (const dirent* entry = readdir(stream.get())) {
    std::string name = entry->d_name;
    if (name != "." && name != "..") found.push_back(std::move(name));
  }
  if (errno != 0) return last_error();
  std::ranges::sort(found);
  return found;
}

Folder::Answer<std::string> Folder::read(const std::string& name, std::size_t max_bytes) const {
  // O_NONBLOCK: a pipe of that name must not hold us up.
  const Descriptor file(openat(descriptor_.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  if (!file.open()) return last_error();
  struct stat status {};
  if (fstat(file.get(), &status) != 0) return last_error();
  if (!S_ISREG(status.st_mode)) return std::unexpected(EINVAL);
  if (static_cast<std::size_t>(status.st_size) > max_bytes) return std::unexpected(EFBIG);
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return last_error();
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  bytes.resize(filled);
  return bytes;
}

int Folder::write_temporary(const std::string& temporary, std::string_view head, std::string_view body,
                            mode_t mode) const {
  const Descriptor file(openat(descriptor_.get(), temporary.c_str(),
                               O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, mode));
  if (!file.open()) return errno;
  if (const int error = write_all(file.get(), head); error != 0) return error;
  if (const int error = write_all(file.get(), body); error != 0) return error;
  return flush(file.get());
}

int Folder::write(const std::string& name, const std::string& temporary, std::string_view head, std::string_view body,
                  mode_t mode) const {
  int error = write_temporary(temporary, head, body, mode);
  if (error == 0) error = rename(temporary, name);
  if (error != 0) {
    (void)remove(temporary);
    return error;
  }
  error = sync();
  if (error != 0) (void)remove(name);
  return error;
}

int Folder::rename(const std::string& from, const std::string& to) const {
  return renameat(descriptor_.get(), from.c_str(), descriptor_.get(), to.c_str()) == 0 ? 0 : errno;
}

int Folder::remove(const std::string& name) const {
  return unlinkat(descriptor_.get(), name.c_str(), 0) == 0 ? 0 : errno;
}

int Folder::sync() const { return flush(descriptor_.get()); }

Folder::Answer<Descriptor> Folder::lock(const std::string& name) const {
  Descriptor file(openat(descriptor_.get(), name.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kFileMode));
  if (!file.open()) return last_error();
  if (flock(file.get(), LOCK_EX | LOCK_NB) != 0) return last_error();
  return file;
}

}  // namespace beltpick::service
