#include "link/fingerprint.hpp"

#include <gnutls/gnutls.h>
#include <gnutls/x509.h>

#include <memory>
#include <optional>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::link {
namespace {

constexpr std::string_view kPrefix = "sha256:";

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

struct FreeCertificate {
  void operator()(gnutls_x509_crt_int* certificate) const { gnutls_x509_crt_deinit(certificate); }
};

}  // namespace

std::string Fingerprint::text() const {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text(kPrefix);
  for (const std::uint8_t byte : sha256) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

std::string Fingerprint::curl_pin() const {
  const gnutls_datum_t bytes{const_cast<unsigned char*>(sha256.data()), static_cast<unsigned>(sha256.size())};
  gnutls_datum_t base64{};
  if (gnutls_base64_encode2(&bytes, &base64) != GNUTLS_E_SUCCESS) throw std::bad_alloc();
  const std::string pin = "sha256//" + std::string(reinterpret_cast<const char*>(base64.data), base64.size);
  gnutls_free(base64.data);
  return pin;
}

Result<Fingerprint> parse_fingerprint(std::string_view text, const std::string& where) {
  std::string_view rest = text;
  if (rest.starts_with(kPrefix)) rest.remove_prefix(kPrefix.size());
  Fingerprint fingerprint;
  std::size_t digits = 0;
  for (const char c : rest) {
    if (c == ':') continue;
    const auto value = hex_digit(c);
    if (!value || digits == 64) {
      digits = 0;
      break;
    }
    std::uint8_t& byte = fingerprint.sha256[digits++ / 2];
    byte = static_cast<std::uint8_t>(byte << 4U | *value);
  }
  if (digits == 64) return fingerprint;
  return failure(ResultCode::kValueOutOfRange,
                 "%s: expected 'sha256:' and 64 hex digits as the appliance prints them, found '%s'; see its log or "
                 "its file tls/fingerprint",
                 where.c_str(), contract_io::one_line(text).substr(0, 100).c_str());
}

Result<Fingerprint> fingerprint_of_certificate(std::string_view pem) {
  gnutls_x509_crt_t raw = nullptr;
  if (gnutls_x509_crt_init(&raw) != GNUTLS_E_SUCCESS) throw std::bad_alloc();
  const std::unique_ptr<gnutls_x509_crt_int, FreeCertificate> certificate(raw);
  const gnutls_datum_t bytes{reinterpret_cast<unsigned char*>(const_cast<char*>(pem.data())),
                             static_cast<unsigned>(pem.size())};
  int status = gnutls_x509_crt_import(certificate.get(), &bytes, GNUTLS_X509_FMT_PEM);
  Fingerprint fingerprint;
  std::size_t size = fingerprint.sha256.size();
  if (status == GNUTLS_E_SUCCESS) {
    status = gnutls_x509_crt_get_key_id(certificate.get(), GNUTLS_KEYID_USE_SHA256, fingerprint.sha256.data(), &size);
  }
  if (status == GNUTLS_E_SUCCESS && size == fingerprint.sha256.size()) return fingerprint;
  return failure(ResultCode::kFormatInvalid, "certificate: expected one with a public key, found: %s",
                 gnutls_strerror(status));
}

}  // namespace beltpick::link
