#include "temporary_file.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::cli {

Result<TemporaryFile> TemporaryFile::make(std::string_view ending, std::string_view bytes) {
  std::error_code none;
  std::string path = (std::filesystem::temp_directory_path(none) / "beltpick-XXXXXX").string();
  path += ending;
  const int fd = ::mkstemps(path.data(), static_cast<int>(ending.size()));
  if (fd < 0) {
    return failure(ResultCode::kFileNotWritten, "%s: cannot be made (%s); check the folder for temporary files",
                   path.c_str(), std::strerror(errno));
  }
  ::close(fd);
  TemporaryFile file(path);
  if (auto written = contract_io::write_file(path, bytes); !written) return std::unexpected(written.error());
  return file;
}

TemporaryFile::TemporaryFile(TemporaryFile&& other) noexcept : path_(std::exchange(other.path_, {})) {}

TemporaryFile::~TemporaryFile() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

}  // namespace beltpick::cli
