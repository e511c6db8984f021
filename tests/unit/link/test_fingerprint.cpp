#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "link/fingerprint.hpp"

using namespace beltpick;

namespace {

// openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256; its fingerprint by
// openssl x509 -pubkey -noout | openssl pkey -pubin -outform DER | sha256sum
constexpr const char* kCertificate = R"(-----BEGIN CERTIFICATE-----
MIIBbDCCAROgAwIBAgIUFccVkH8bitOk5Zvn5S8N3wFgorcwCgYIKoZIzj0EAwIw
DDEKMAgGA1UEAwwBeDAeFw0yNjExMjIwNzAxMzJaFw0yNjEyMDIwNzAxMzJaMAwx
CjAIBgNVBAMMAXgwWTATBgcqhkjOPQIBBggqhkjOPQMBBwNCAARBWeMwdae5Ki1H
9t4CixZjeFatNrUcAFnc59o2woaMq3hS1VEHybw8vwO2/V1N4+v2K5z1Oql6LdHO
QCk8Yk7Oo1MwUTAdBgNVHQ4EFgQUtUi925eTLEN08Ah8YCop8dubQ1owHwYDVR0j
BBgwFoAUtUi925eTLEN08Ah8YCop8dubQ1owDwYDVR0TAQH/BAUwAwEB/zAKBggq
hkjOPQQDAgNHADBEAiBk2od85ozW7jpADkMNdjtiHm87qKJjYppk5peET+omtgIg
Ppn1/rRkLcpezxZtPKhrPWasG08mjYGvmxukbMg9SEs=
-----END CERTIFICATE-----
)";
constexpr const char* kHex = "0ebced0b38664f2248712dd2133973cc3bc0c0bfe7cdc61e024474d7d9902266";
constexpr const char* kBase64 = "DrztCzhmTyJIcS3SEzlzzDvAwL/nzcYeAkR019mQImY=";

}  // namespace

TEST_CASE("The fingerprint of a certificate is the one that openssl tells", "[link]") {
  const auto found = link::fingerprint_of_certificate(kCertificate);
  REQUIRE(found);
  CHECK(found->text() == std::string("sha256:") + kHex);
  CHECK(found->curl_pin() == std::string("sha256//") + kBase64);
}

TEST_CASE("What is no certificate has no fingerprint", "[link]") {
  const std::string whole = kCertificate;
  for (std::size_t size = 0; size + 40 < whole.size(); size += 7) {
    const auto found = link::fingerprint_of_certificate(whole.substr(0, size));
    REQUIRE_FALSE(found);
    CHECK(found.error().code == ResultCode::kFormatInvalid);
  }
}

TEST_CASE("A fingerprint is read as people copy it", "[link]") {
  std::string capitals, parted;
  for (const char* at = kHex; *at != 0; at += 2) {
    parted += (parted.empty() ? "" : ":") + std::string(at, 2);
    for (int i = 0; i < 2; ++i) capitals += at[i] >= 'a' ? static_cast<char>(at[i] - 32) : at[i];
  }
  for (const std::string& text : {std::string("sha256:") + kHex, std::string(kHex), capitals, "sha256:" + parted}) {
    const auto found = link::parse_fingerprint(text, "--fingerprint");
    INFO(text);
    REQUIRE(found);
    CHECK(found->text() == std::string("sha256:") + kHex);
  }
}

TEST_CASE("What is no fingerprint is refused", "[link]") {
  const std::string hex = kHex;
  for (const std::string& text : {std::string(), std::string("sha256:"), hex.substr(1), hex + "0", "sha1:" + hex,
                                  hex.substr(0, 63) + "g", hex + "\n", " " + hex, std::string("sha256//") + kBase64}) {
    const auto found = link::parse_fingerprint(text, "--fingerprint");
    INFO(text);
    REQUIRE_FALSE(found);
    CHECK(found.error().code == ResultCode::kValueOutOfRange);
    CHECK(found.error().text().find("--fingerprint") == 0);
  }
}
