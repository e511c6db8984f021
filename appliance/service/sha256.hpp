// SHA-256 in hex, by GnuTLS.
#pragma once

#include <string>
#include <string_view>

namespace beltpick::service {

// 64 lower-case hex digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace beltpick::service
