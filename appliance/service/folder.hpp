// Folder: an open folder of the disk and the few operations that the store does in it, each so that a crash or a power
// cut leaves the state before or after it. Names are plain file names: nothing outside the folder can be reached, and
// symbolic links in it are not followed. Errors are errno's numbers.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace beltpick::service {

// A file descriptor that is closed with its owner.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool open() const { return fd_ >= 0; }
  // Somebody else closes it.
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_ = -1;
};

class Folder {
 public:
  template <class T>
  using Answer = std::expected<T, int>;

  static constexpr mode_t kFileMode = 0640;

  // Makes `path` and its parents where they are missing. `path` itself may be a symbolic link.
  static Answer<Folder> make(const std::filesystem::path& path);

  // `path` itself may be a symbolic link; nothing is made.
  static Answer<Folder> open(const std::filesystem::path& path);

  // A folder in this one; ENOENT where there is none, ELOOP or ENOTDIR where it is something else.
  [[nodiscard]] Answer<Folder> sub(const std::string& name) const;
  // The same, made where it is missing, and flushed in any case: whoever made it may have died before that.
  [[nodiscard]] Answer<Folder> make_sub(const std::string& name) const;

  // Everything in it, sorted.
  [[nodiscard]] Answer<std::vector<std::string>> names() const;

  // A whole regular file. EFBIG: more than `max_bytes`; ELOOP: a symbolic link; EINVAL: no regular file.
  [[nodiscard]] Answer<std::string> read(const std::string& name, std::size_t max_bytes) const;

  // Makes `name` of two pieces by way of `temporary`: when 0 comes back it is on the disk to stay; after an error it is
  // not there, nor is the temporary.
  [[nodiscard]] int write(const std::string& name, const std::string& temporary, std::string_view head,
                          std::string_view body, mode_t mode = kFileMode) const;

  // Not flushed to the disk: sync() does that.
  [[nodiscard]] int rename(const std::string& from, const std::string& to) const;
  [[nodiscard]] int remove(const std::string& name) const;
  [[nodiscard]] int sync() const;

  // The file `name`, made where needed and locked for this process; EWOULDBLOCK where another one holds it.
  [[nodiscard]] Answer<Descriptor> lock(const std::string& name) const;

 private:
  explicit Folder(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}

  [[nodiscard]] int write_temporary(const std::string& temporary, std::string_view head, std::string_view body,
                                    mode_t mode) const;

  Descriptor descriptor_;
};

}  // namespace beltpick::service
