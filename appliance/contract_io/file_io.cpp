#include "contract_io/file_io.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "contract/result_codes.hpp"

namespace beltpick::contract_io {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

std::unexpected<Error> not_opened(const std::string& name, int error) {
  if (error == ENOENT || error == ENOTDIR) {
    return failure(ResultCode::kFileNotFound, "%s: expected a file, found none of that name; check the path",
                   name.c_str());
  }
  return failure(ResultCode::kFileUnreadable, "%s: expected a readable file, found: %s; check its permissions",
                 name.c_str(), std::strerror(error));
}

std::unexpected<Error> not_written(const std::string& name, int error) {
  return failure(write_error_code(error),
                 "%s: expected to write here, found: %s; check the folder, its permissions and the free space",
                 name.c_str(), std::strerror(error));
}

// Where a symbolic link leads: renaming would replace the link instead.
std::filesystem::path followed(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_symlink(path, error)) return path;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, error);
  return error ? path : target;
}

// /dev/null, a pipe, a terminal: written to, never replaced.
bool is_device(const std::filesystem::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

}  // namespace

ResultCode write_error_code(int error) {
  return error == ENOSPC || error == EDQUOT ? ResultCode::kDiskFull : ResultCode::kFileNotWritten;
}

std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return line;
}

Result<std::string> read_file(const std::filesystem::path& path, std::size_t max_bytes) {
  const std::string name = one_line(path.string());
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return not_opened(name, errno);
  struct stat status {};
  if (fstat(fileno(file.get()), &status) != 0) return not_opened(name, errno);
  if (S_ISDIR(status.st_mode)) {
    return failure(ResultCode::kFileUnreadable, "%s: expected a file, found a folder; name the file in it",
                   name.c_str());
  }
  std::string bytes;
  if (S_ISREG(status.st_mode) && static_cast<std::size_t>(status.st_size) <= max_bytes) {
    bytes.reserve(static_cast<std::size_t>(status.st_size));
  }
  char block[1U << 16U];
  std::size_t got = 0;
  while ((got = std::fread(block, 1, sizeof block, file.get())) > 0) {
    if (bytes.size() + got > max_bytes) {
      return failure(ResultCode::kFileUnreadable, "%s: expected at most %zu bytes, found more; is it the right file?",
                     name.c_str(), max_bytes);
    }
    bytes.append(block, got);
  }
  if (std::ferror(file.get()) != 0) return not_opened(name, errno);
  return bytes;
}

Result<void> write_file(const std::filesystem::path& path, std::string_view bytes) {
  const std::string name = one_line(path.string());
  const std::filesystem::path target = followed(path);
  const bool direct = is_device(target);
  const std::string written = direct ? target.string() : target.string() + ".part" + std::to_string(getpid());
  File file(std::fopen(written.c_str(), "wb"));
  if (!file) return not_written(name, errno);
  bool whole = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  whole = std::fflush(file.get()) == 0 && whole;
  int error = errno;
  file.reset();
  if (whole && !direct) {
    whole = std::rename(written.c_str(), target.c_str()) == 0;
    error = errno;
  }
  if (whole) return {};
  if (!direct) std::remove(written.c_str());
  return not_written(name, error);
}

Result<void> make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error && std::filesystem::is_directory(path, error)) return {};
  return failure(write_error_code(error.value()),
                 "%s: expected to make this folder, found: %s; check the path and its permissions",
                 one_line(path.string()).c_str(), error ? error.message().c_str() : "a file of that name");
}

}  // namespace beltpick::contract_io
