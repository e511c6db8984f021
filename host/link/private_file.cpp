#include "link/private_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::link {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 16U;
constexpr mode_t kOthers = S_IRWXG | S_IRWXO;
constexpr mode_t kOthersWrite = S_IWGRP | S_IWOTH;

std::unexpected<Error> not_written(const std::filesystem::path& path, int error) {
  return failure(ResultCode::kFileNotWritten, "%s: expected to write here, found: %s; check the folder and its owner",
                 contract_io::one_line(path.string()).c_str(), std::strerror(error));
}

// Refuses what another user owns or could have touched: the bits of `forbidden` must not be set.
Result<void> check_owner(const std::filesystem::path& path, mode_t forbidden, const char* mend) {
  struct stat status {};
  const std::string name = contract_io::one_line(path.string());
  if (stat(path.c_str(), &status) != 0) {
    return failure(errno == ENOENT || errno == ENOTDIR ? ResultCode::kFileNotFound : ResultCode::kFileUnreadable,
                   "%s: expected to find it, found: %s", name.c_str(), std::strerror(errno));
  }
  if (status.st_uid != geteuid()) {
    return failure(ResultCode::kFileUnreadable,
                   "%s: expected a file of your own (user %u), found user %u's; run beltpick as that user, or enrol",
                   name.c_str(), geteuid(), status.st_uid);
  }
  if ((status.st_mode & forbidden) == 0) return {};
  return failure(ResultCode::kFileUnreadable,
                 "%s: expected that only you may touch it, found mode %o; 'chmod %s' it, and have the token revoked if "
                 "others may have read it",
                 name.c_str(), status.st_mode & 07777U, mend);
}

Result<void> make_private_folder(const std::filesystem::path& folder) {
  if (folder.empty() || std::filesystem::is_directory(folder)) return {};
  if (auto parent = make_private_folder(folder.parent_path()); !parent) return parent;
  if (mkdir(folder.c_str(), S_IRWXU) == 0 || errno == EEXIST) return {};
  return not_written(folder, errno);
}

// All of `bytes` to a new file that only this user may read; 0 or errno.
int write_new(const std::filesystem::path& path, std::string_view bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return errno;
  int error = 0;
  while (!bytes.empty() && error == 0) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
    if (written < 0 && errno != EINTR) error = errno;
  }
  if (error == 0 && fsync(file) != 0) error = errno;
  close(file);
  return error;
}

}  // namespace

Result<std::string> read_private_file(const std::filesystem::path& path) {
  if (auto alone = check_owner(path, kOthers, "600"); !alone) return std::unexpected(alone.error());
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (auto alone = check_owner(folder, kOthersWrite, "700"); !alone) return std::unexpected(alone.error());
  return contract_io::read_file(path, kMaxBytes);
}

Result<void> prepare_private_folder(const std::filesystem::path& folder) {
  if (auto made = make_private_folder(folder); !made) return made;
  if (access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return not_written(folder, errno);
}

Result<void> write_private_file(const std::filesystem::path& path, std::string_view bytes) {
  if (auto made = make_private_folder(path.parent_path()); !made) return made;
  const std::filesystem::path part = path.string() + ".part" + std::to_string(getpid());
  int error = write_new(part, bytes);
  if (error == 0 && rename(part.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return {};
  if (error != EEXIST) unlink(part.c_str());
  return not_written(path, error);
}

}  // namespace beltpick::link
