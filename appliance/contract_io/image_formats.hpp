// What the image readers share: the formats behind image_io, and the reduction of colour to grey.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract_io/image_io.hpp"

namespace beltpick::contract_io {

// 0.299 R + 0.587 G + 0.114 B, rounded; exact for R = G = B.
constexpr std::uint32_t grey_from_rgb(std::uint32_t red, std::uint32_t green, std::uint32_t blue) {
  return (299 * red + 587 * green + 114 * blue + 500) / 1000;
}

[[nodiscard]] bool looks_like_png(std::string_view bytes);
[[nodiscard]] bool looks_like_bmp(std::string_view bytes);
Result<GreyImage> decode_png(std::string_view bytes, const std::string& name);
Result<GreyImage> decode_bmp(std::string_view bytes, const std::string& name);

}  // namespace beltpick::contract_io
