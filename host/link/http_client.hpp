// HttpClient: HTTPS requests to one appliance, whose public key must be the expected one before anything is sent.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/api.hpp"
#include "link/address.hpp"
#include "link/fingerprint.hpp"

namespace beltpick::link {

struct HttpRequest {
  HttpMethod method = HttpMethod::kGet;
  std::string path;
  std::string token{};      // for Authorization; none where empty
  std::string_view body{};  // of PUT and POST
  std::string_view content_type = "application/json";
};

struct HttpAnswer {
  int status = 0;
  std::string body;
  std::string version;               // header kVersionHeader
  std::optional<int> retry_after_s;  // header Retry-After
};

// Bytes sent or received so far, and in all where known (else 0).
using Progress = std::function<void(std::size_t done, std::size_t total)>;

// What an unknown appliance shows to somebody who tells it nothing.
struct FirstContact {
  Fingerprint fingerprint;
  HttpAnswer health;
};

class HttpClient {
 public:
  // Asks for GET `health_path` without any secret and without expecting a key. Error: kServiceUnreachable.
  static Result<FirstContact> first_contact(const Address& address, const std::string& health_path);

  // Connects with the first request and keeps the connection. Neither proxies nor redirects are followed.
  HttpClient(Address address, const Fingerprint& fingerprint);
  HttpClient(HttpClient&&) noexcept;
  HttpClient& operator=(HttpClient&&) noexcept;
  ~HttpClient();

  // Any HTTP status is an answer. Errors: kServiceUnreachable; kCertificateChanged, with both fingerprints; nothing was
  // sent then.
  Result<HttpAnswer> send(const HttpRequest& request, const Progress& progress = {});

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace beltpick::link
