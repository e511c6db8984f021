// A CAPTURE: capture.json and the frames it names, in a folder or a .zip; and sequence.json.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

class CaptureSource;  // a folder or a zip

// Reads a capture frame by frame, so that it can be folded without holding all its images.
class CaptureReader {
 public:
  // `path`: a folder, a .zip (the capture at its root or in its one folder), or the capture.json itself. Reads the
  // header and the first frame, and sees that every frame's file is there. Errors: kFileNotFound, kFileUnreadable,
  // kFormatInvalid, kMemberMissing, kValueOutOfRange, kVersionUnsupported, kFrameMissing.
  static Result<CaptureReader> open(const std::filesystem::path& path, Warnings& warnings);

  CaptureReader(CaptureReader&&) noexcept;
  CaptureReader& operator=(CaptureReader&&) noexcept;
  ~CaptureReader();

  [[nodiscard]] const CaptureHeader& header() const { return header_; }
  [[nodiscard]] int frames() const { return static_cast<int>(header_.sequence.frames.size()); }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  [[nodiscard]] int bits() const { return bits_; }  // 8 or 16, of every frame

  // Frame `index`. Errors: kFileUnreadable or kFormatInvalid of its file, kFrameSizeMismatch where it differs from the
  // first frame in size or depth. Colour warns once a capture.
  Result<GreyImage> image(int index, Warnings& warnings);

 private:
  CaptureReader();
  // Sees that all files are there, and takes size and depth from the first frame.
  Result<void> adopt_first_frame(Warnings& warnings);
  Result<GreyImage> load(int index);

  std::unique_ptr<CaptureSource> source_;
  CaptureHeader header_;
  int rows_ = 0, cols_ = 0, bits_ = 8;
  bool warned_colour_ = false;
};

// capture.json's text. `full_scale` is 0 where the file does not tell it. `name` stands in messages.
Result<CaptureHeader> parse_capture(std::string_view text, const std::string& name, Warnings& warnings);
Result<void> write_capture(const std::filesystem::path& path, const CaptureHeader& header);

// sequence.json: the projected frames; also takes a capture.json, whose members include these.
Result<Sequence> read_sequence(const std::filesystem::path& path, Warnings& warnings);
Result<void> write_sequence(const std::filesystem::path& path, const Sequence& sequence);

}  // namespace beltpick::contract_io
