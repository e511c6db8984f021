// Where the files of a capture come from: a folder, or a zip with the capture at its root or in its one folder.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/result.hpp"

namespace beltpick::contract_io {

class CaptureSource {
 public:
  // Errors: kFileNotFound, kFileUnreadable, kFormatInvalid.
  static Result<std::unique_ptr<CaptureSource>> open(const std::filesystem::path& path);

  CaptureSource() = default;
  CaptureSource(const CaptureSource&) = delete;
  CaptureSource& operator=(const CaptureSource&) = delete;
  virtual ~CaptureSource() = default;

  [[nodiscard]] virtual bool has(const std::string& file) const = 0;
  virtual Result<std::string> read(const std::string& file) = 0;
  // How a file of the capture is called in messages.
  [[nodiscard]] virtual std::string name_of(const std::string& file) const = 0;
  // The capture's own name: its folder's or its zip's stem.
  [[nodiscard]] virtual std::string id() const = 0;
};

// The zip behind CaptureSource::open.
Result<std::unique_ptr<CaptureSource>> open_zip_source(const std::filesystem::path& path);

inline constexpr const char* kCaptureFile = "capture.json";

}  // namespace beltpick::contract_io
