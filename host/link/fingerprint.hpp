// Fingerprint: SHA-256 of an appliance's public key (its DER SubjectPublicKeyInfo), by which it is known again.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace beltpick::link {

struct Fingerprint {
  std::array<std::uint8_t, 32> sha256{};

  // "sha256:" and 64 hex digits, as the appliance prints it.
  [[nodiscard]] std::string text() const;
  // As libcurl's CURLOPT_PINNEDPUBLICKEY takes it.
  [[nodiscard]] std::string curl_pin() const;

  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};

// "sha256:" may be missing, the digits may be in capitals and parted by ':'. `where` stands in the message. Error:
// kValueOutOfRange.
Result<Fingerprint> parse_fingerprint(std::string_view text, const std::string& where);

// Of the public key in a certificate as PEM. Error: kFormatInvalid.
Result<Fingerprint> fingerprint_of_certificate(std::string_view pem);

}  // namespace beltpick::link
