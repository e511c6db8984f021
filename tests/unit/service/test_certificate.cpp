// The certificate is made once, kept, and belongs to its key.
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <ctime>
#include <fstream>

#include "contract/result_codes.hpp"
#include "service/certificate.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::service;
using namespace beltpick::test;

namespace {

Result<Certificate> open_in(const TempFolder& folder) {
  std::vector<std::string> notes;
  return open_certificate(*Folder::make(folder.path()), notes);
}

}  // namespace

TEST_CASE("a certificate is made at the first start, for ten years, and kept", "[certificate]") {
  const TempFolder folder;
  const auto made = open_in(folder);
  REQUIRE(made);
  struct stat status {};
  REQUIRE(stat((folder / "tls/key.pem").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777U) == 0600U);

  gnutls_x509_crt_t certificate = nullptr;
  REQUIRE(gnutls_x509_crt_init(&certificate) == 0);
  std::string pem = made->certificate_pem;
  const gnutls_datum_t text{reinterpret_cast<unsigned char*>(pem.data()), static_cast<unsigned>(pem.size())};
  REQUIRE(gnutls_x509_crt_import(certificate, &text, GNUTLS_X509_FMT_PEM) == 0);
  unsigned bits = 0;
  CHECK(gnutls_x509_crt_get_pk_algorithm(certificate, &bits) == GNUTLS_PK_ECDSA);
  CHECK(gnutls_x509_crt_check_hostname(certificate, "localhost") != 0);
  CHECK(gnutls_x509_crt_check_hostname(certificate, "127.0.0.1") != 0);
  CHECK(gnutls_x509_crt_check_hostname(certificate, "elsewhere.example") == 0);
  const std::time_t days = (gnutls_x509_crt_get_expiration_time(certificate) - std::time(nullptr)) / 86400;
  CHECK(days >= 3640);
  CHECK(days <= 3660);
  gnutls_x509_crt_deinit(certificate);

  const auto again = open_in(folder);
  REQUIRE(again);
  CHECK(again->fingerprint == made->fingerprint);
  CHECK(again->key_pem == made->key_pem);
  CHECK(open_in(TempFolder())->fingerprint != made->fingerprint);
}

TEST_CASE("a key that is not the certificate's is refused, never replaced", "[certificate]") {
  const TempFolder folder, other;
  REQUIRE(open_in(folder));
  REQUIRE(open_in(other));
  const std::string key = file_bytes(folder / "tls/key.pem");
  for (const std::string& wrong : {file_bytes(other / "tls/key.pem"), std::string("nonsense"), std::string()}) {
    std::ofstream(folder / "tls/key.pem") << wrong;
    const auto refused = open_in(folder);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ResultCode::kFormatInvalid);
    CHECK(file_bytes(folder / "tls/key.pem") == wrong);
  }
  std::ofstream(folder / "tls/key.pem") << key;
  CHECK(open_in(folder));

  // A start that was cut off after the key: both are made.
  std::filesystem::remove(folder / "tls/certificate.pem");
  CHECK(open_in(folder));
  CHECK(file_bytes(folder / "tls/key.pem") != key);
  std::filesystem::remove(folder / "tls/key.pem");
  CHECK_FALSE(open_in(folder));
}
