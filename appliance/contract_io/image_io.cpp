#include "contract_io/image_io.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_formats.hpp"

namespace beltpick::contract_io {

Result<GreyImage> decode_grey_image(std::string_view bytes, const std::string& name) {
  if (looks_like_png(bytes)) return decode_png(bytes, name);
  if (looks_like_bmp(bytes)) return decode_bmp(bytes, name);
  return failure(ResultCode::kFormatInvalid,
                 "%s: expected a PNG or BMP image, found %s; save it as 8- or 16-bit grey PNG", name.c_str(),
                 bytes.empty() ? "an empty file" : "another format");
}

Result<GreyImage> read_grey_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  return decode_grey_image(*bytes, one_line(path.string()));
}

Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint8_t> image) {
  return write_file(path, encode_png(image));
}

Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint16_t> image) {
  return write_file(path, encode_png(image));
}

Result<void> write_png(const std::filesystem::path& path, ImageView<const Rgb> image) {
  return write_file(path, encode_png(image));
}

}  // namespace beltpick::contract_io
