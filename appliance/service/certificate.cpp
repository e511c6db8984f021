#include "service/certificate.hpp"

#include <arpa/inet.h>
#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <memory>
#include <stdexcept>

#include "contract/result_codes.hpp"
#include "service/secrets.hpp"

namespace beltpick::service {
namespace {

constexpr const char* kFolder = "tls";
constexpr const char* kKeyFile = "key.pem";
constexpr const char* kCertificateFile = "certificate.pem";
constexpr const char* kFingerprintFile = "fingerprint";
constexpr std::size_t kMaxFile = std::size_t{1} << 16U;
constexpr std::time_t kDay_s = 24 * 3600;
constexpr std::time_t kLife_s = 3650 * kDay_s;
constexpr std::time_t kWarn_s = 90 * kDay_s;

struct FreeKey {
  void operator()(gnutls_x509_privkey_t key) const { gnutls_x509_privkey_deinit(key); }
};
struct FreeCertificate {
  void operator()(gnutls_x509_crt_t certificate) const { gnutls_x509_crt_deinit(certificate); }
};
using Key = std::unique_ptr<gnutls_x509_privkey_int, FreeKey>;
using Crt = std::unique_ptr<gnutls_x509_crt_int, FreeCertificate>;

// Making a certificate has no expected failure: GnuTLS is there or it is not.
void must(int status) {
  if (status < 0) throw std::runtime_error(std::string("GnuTLS: ") + gnutls_strerror(status));
}

Key new_key() {
  gnutls_x509_privkey_t key = nullptr;
  must(gnutls_x509_privkey_init(&key));
  return Key(key);
}

Crt new_certificate() {
  gnutls_x509_crt_t certificate = nullptr;
  must(gnutls_x509_crt_init(&certificate));
  return Crt(certificate);
}

template <class Export>
std::string exported(Export write) {
  gnutls_datum_t datum{nullptr, 0};
  must(write(&datum));
  std::string text(reinterpret_cast<const char*>(datum.data), datum.size);
  gnutls_free(datum.data);
  return text;
}

gnutls_datum_t datum(const std::string& text) {
  return {reinterpret_cast<unsigned char*>(const_cast<char*>(text.data())), static_cast<unsigned>(text.size())};
}

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "beltpick";
  return name.data();
}

void add_name(gnutls_x509_crt_t certificate, gnutls_x509_subject_alt_name_t kind, const void* name, std::size_t bytes) {
  must(gnutls_x509_crt_set_subject_alt_name(certificate, kind, name, static_cast<unsigned>(bytes), GNUTLS_FSAN_APPEND));
}

// The addresses of all network cards, loopback among them.
void add_addresses(gnutls_x509_crt_t certificate) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return;
  for (const ifaddrs* at = list; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr) continue;
    if (at->ifa_addr->sa_family == AF_INET) {
      const auto& v4 = *reinterpret_cast<const sockaddr_in*>(at->ifa_addr);
      add_name(certificate, GNUTLS_SAN_IPADDRESS, &v4.sin_addr, sizeof v4.sin_addr);
    } else if (at->ifa_addr->sa_family == AF_INET6) {
      const auto& v6 = *reinterpret_cast<const sockaddr_in6*>(at->ifa_addr);
      if (!IN6_IS_ADDR_LINKLOCAL(&v6.sin6_addr)) {
        add_name(certificate, GNUTLS_SAN_IPADDRESS, &v6.sin6_addr, sizeof v6.sin6_addr);
      }
    }
  }
  freeifaddrs(list);
}

void fill_subject(gnutls_x509_crt_t certificate) {
  const std::string host = host_name();
  static constexpr std::string_view kOrganisation = "beltpick appliance";
  must(gnutls_x509_crt_set_dn_by_oid(certificate, GNUTLS_OID_X520_ORGANIZATION_NAME, 0, kOrganisation.data(),
                                     static_cast<unsigned>(kOrganisation.size())));
  must(gnutls_x509_crt_set_dn_by_oid(certificate, GNUTLS_OID_X520_COMMON_NAME, 0, host.data(),
                                     static_cast<unsigned>(std::min<std::size_t>(host.size(), 64))));
  for (const std::string& name : {host, host + ".local", std::string("localhost")}) {
    add_name(certificate, GNUTLS_SAN_DNSNAME, name.data(), name.size());
  }
  add_addresses(certificate);
}

void fill_life(gnutls_x509_crt_t certificate) {
  std::array<unsigned char, 16> serial{};
  must(gnutls_rnd(GNUTLS_RND_NONCE, serial.data(), serial.size()));
  serial[0] = static_cast<unsigned char>((serial[0] & 0x7FU) | 1U);  // positive and not zero, as the standard asks
  must(gnutls_x509_crt_set_serial(certificate, serial.data(), serial.size()));
  const std::time_t now = std::time(nullptr);
  must(gnutls_x509_crt_set_activation_time(certificate, now - kDay_s));
  must(gnutls_x509_crt_set_expiration_time(certificate, now + kLife_s));
}

Certificate make() {
  const Key key = new_key();
  must(gnutls_x509_privkey_generate2(key.get(), GNUTLS_PK_ECDSA, GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0,
                                     nullptr, 0));
  const Crt certificate = new_certificate();
  must(gnutls_x509_crt_set_version(certificate.get(), 3));
  must(gnutls_x509_crt_set_key(certificate.get(), key.get()));
  fill_subject(certificate.get());
  fill_life(certificate.get());
  must(gnutls_x509_crt_set_basic_constraints(certificate.get(), 0, -1));
  must(gnutls_x509_crt_set_key_usage(certificate.get(), GNUTLS_KEY_DIGITAL_SIGNATURE));
  must(gnutls_x509_crt_set_key_purpose_oid(certificate.get(), GNUTLS_KP_TLS_WWW_SERVER, 0));
  must(gnutls_x509_crt_sign2(certificate.get(), certificate.get(), key.get(), GNUTLS_DIG_SHA256, 0));
  Certificate made;
  made.key_pem =
      exported([&](gnutls_datum_t* out) { return gnutls_x509_privkey_export2(key.get(), GNUTLS_X509_FMT_PEM, out); });
  made.certificate_pem = exported(
      [&](gnutls_datum_t* out) { return gnutls_x509_crt_export2(certificate.get(), GNUTLS_X509_FMT_PEM, out); });
  return made;
}

std::string fingerprint_text(const unsigned char* bytes, std::size_t count) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "sha256:";
  for (std::size_t i = 0; i < count; ++i) {
    text += kDigits[bytes[i] >> 4U];
    text += kDigits[bytes[i] & 15U];
  }
  return text;
}

// Fills the fingerprint; tells what is wrong with the two files.
Result<void> examine(Certificate& certificate, std::vector<std::string>& notes) {
  const Key key = new_key();
  const Crt crt = new_certificate();
  const gnutls_datum_t key_text = datum(certificate.key_pem);
  const gnutls_datum_t crt_text = datum(certificate.certificate_pem);
  std::array<unsigned char, 64> of_key{}, of_certificate{};
  std::size_t bytes = of_key.size(), more_bytes = of_certificate.size();
  const bool good =
      gnutls_x509_privkey_import(key.get(), &key_text, GNUTLS_X509_FMT_PEM) == 0 &&
      gnutls_x509_crt_import(crt.get(), &crt_text, GNUTLS_X509_FMT_PEM) == 0 &&
      gnutls_x509_privkey_get_key_id(key.get(), GNUTLS_KEYID_USE_SHA256, of_key.data(), &bytes) == 0 &&
      gnutls_x509_crt_get_key_id(crt.get(), GNUTLS_KEYID_USE_SHA256, of_certificate.data(), &more_bytes) == 0 &&
      of_key == of_certificate;
  if (!good) {
    return failure(ResultCode::kFormatInvalid,
                   "%s/%s and %s in the state folder: expected a certificate and its key, found something else; put "
                   "them right, or take both away: new ones are made, and everybody enrols anew",
                   kFolder, kKeyFile, kCertificateFile);
  }
  certificate.fingerprint = fingerprint_text(of_certificate.data(), more_bytes);
  if (gnutls_x509_crt_get_expiration_time(crt.get()) < std::time(nullptr) + kWarn_s) {
    notes.emplace_back("the service's certificate ends soon, or has ended: make a new one and enrol anew");
  }
  return {};
}

std::unexpected<Error> unusable(int error) {
  return failure(ResultCode::kFileUnreadable, "%s in the state folder: expected key and certificate, found: %s",
                 kFolder, std::strerror(error));
}

}  // namespace

Result<Certificate> open_certificate(const Folder& state, std::vector<std::string>& notes) {
  const auto folder = state.make_sub(kFolder);
  if (!folder) return unusable(folder.error());
  const auto key = folder->read(kKeyFile, kMaxFile);
  const auto pem = folder->read(kCertificateFile, kMaxFile);
  Certificate certificate;
  if (key && pem) {
    certificate = {*key, *pem, ""};
  } else if (!pem && pem.error() == ENOENT) {
    certificate = make();  // a key alone is of a start that was cut off
    if (const auto done = write_secret(*folder, kKeyFile, certificate.key_pem); !done) {
      return std::unexpected(done.error());
    }
    if (const auto done = write_secret(*folder, kCertificateFile, certificate.certificate_pem); !done) {
      return std::unexpected(done.error());
    }
    notes.emplace_back("a certificate was made for the service");
  } else {
    return unusable(key ? pem.error() : key.error());
  }
  if (const auto good = examine(certificate, notes); !good) return std::unexpected(good.error());
  if (const std::string text = certificate.fingerprint + "\n"; folder->read(kFingerprintFile, kMaxFile) != text) {
    if (const auto done = write_secret(*folder, kFingerprintFile, text); !done) return std::unexpected(done.error());
  }
  return certificate;
}

}  // namespace beltpick::service
