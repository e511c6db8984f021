#include "contract_io/capture_io.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/capture_source.hpp"

namespace beltpick::contract_io {

CaptureReader::CaptureReader() = default;
CaptureReader::CaptureReader(CaptureReader&&) noexcept = default;
CaptureReader& CaptureReader::operator=(CaptureReader&&) noexcept = default;
CaptureReader::~CaptureReader() = default;

Result<CaptureReader> CaptureReader::open(const std::filesystem::path& path, Warnings& warnings) {
  auto source = CaptureSource::open(path);
  if (!source) return std::unexpected(source.error());
  CaptureReader reader;
  reader.source_ = std::move(*source);
  const auto text = reader.source_->read(kCaptureFile);
  if (!text) return std::unexpected(text.error());
  auto header = parse_capture(*text, reader.source_->name_of(kCaptureFile), warnings);
  if (!header) return std::unexpected(header.error());
  reader.header_ = std::move(*header);
  if (reader.header_.id.empty()) reader.header_.id = reader.source_->id();
  if (const auto complete = reader.adopt_first_frame(warnings); !complete) return std::unexpected(complete.error());
  return reader;
}

Result<void> CaptureReader::adopt_first_frame(Warnings& warnings) {
  const auto& frames = header_.sequence.frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (source_->has(frames[i].file)) continue;
    return failure(ResultCode::kFrameMissing,
                   "%s: expected the image of frames[%zu], found no such file; copy or capture it again",
                   source_->name_of(frames[i].file).c_str(), i);
  }
  const auto first = load(0);
  if (!first) return std::unexpected(first.error());
  rows_ = first->rows;
  cols_ = first->cols;
  bits_ = first->bits;
  const int most = bits_ == 16 ? 65535 : 255;
  if (header_.full_scale == 0) header_.full_scale = most;
  if (header_.full_scale > most) {
    warnings.push_back(source_->name_of(kCaptureFile) + ": full_scale: " + std::to_string(header_.full_scale) +
                       " is more than " + std::to_string(bits_) + "-bit images can hold: saturation will not be seen");
  }
  return {};
}

Result<GreyImage> CaptureReader::load(int index) {
  const std::string& file = header_.sequence.frames[static_cast<std::size_t>(index)].file;
  const auto bytes = source_->read(file);
  if (!bytes) return std::unexpected(bytes.error());
  return decode_grey_image(*bytes, source_->name_of(file));
}

Result<GreyImage> CaptureReader::image(int index, Warnings& warnings) {
  auto image = load(index);
  if (!image) return image;
  const auto& frames = header_.sequence.frames;
  const std::string name = source_->name_of(frames[static_cast<std::size_t>(index)].file);
  if (image->rows != rows_ || image->cols != cols_ || image->bits != bits_) {
    return failure(ResultCode::kFrameSizeMismatch,
                   "%s: expected %d x %d pixels of %d bits as in %s, found %d x %d of %d; capture again", name.c_str(),
                   cols_, rows_, bits_, frames.front().file.c_str(), image->cols, image->rows, image->bits);
  }
  if (image->from_colour && !warned_colour_) {
    warnings.push_back(name + ": colour is reduced to grey (0.299 R + 0.587 G + 0.114 B); set the camera to mono");
    warned_colour_ = true;
  }
  return image;
}

}  // namespace beltpick::contract_io
