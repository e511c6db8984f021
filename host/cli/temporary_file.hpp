// A file that is there for as long as the object lives, for a program that takes a path.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"

namespace beltpick::cli {

class TemporaryFile {
 public:
  // Error: kFileNotWritten.
  static Result<TemporaryFile> make(std::string_view ending, std::string_view bytes);
  TemporaryFile(TemporaryFile&& other) noexcept;
  TemporaryFile& operator=(TemporaryFile&&) = delete;
  ~TemporaryFile();

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  explicit TemporaryFile(std::string path) : path_(std::move(path)) {}

  std::string path_;
};

}  // namespace beltpick::cli
