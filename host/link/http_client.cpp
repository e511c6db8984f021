#include "link/http_client.hpp"

#include <curl/curl.h>

#include <charconv>
#include <cstring>
#include <new>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::link {
namespace {

constexpr long kConnect_ms = 5000;
constexpr long kWhole_s = 120;   // the longest request: a self-test, or an upload over a slow line
constexpr long kStalled_s = 30;  // without a byte
constexpr std::size_t kMaxAnswer = std::size_t{16} << 20U;  // above the largest item

constexpr const char* method_name(HttpMethod method) {
  switch (method) {
    case HttpMethod::kPut:
      return "PUT";
    case HttpMethod::kPost:
      return "POST";
    case HttpMethod::kDelete:
      return "DELETE";
    case HttpMethod::kGet:
      break;
  }
  return "GET";
}

bool has_body(HttpMethod method) { return method == HttpMethod::kPut || method == HttpMethod::kPost; }

struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using Headers = std::unique_ptr<curl_slist, FreeList>;

void add_header(Headers& headers, const std::string& line) {
  curl_slist* longer = curl_slist_append(headers.get(), line.c_str());
  if (longer == nullptr) throw std::bad_alloc();
  (void)headers.release();
  headers.reset(longer);
}

std::size_t take_body(const char* bytes, std::size_t one, std::size_t count, void* to) {
  auto& body = *static_cast<std::string*>(to);
  if (body.size() + one * count > kMaxAnswer) return 0;
  body.append(bytes, one * count);
  return one * count;
}

struct Upload {
  std::string_view rest;
};

std::size_t give_body(char* to, std::size_t one, std::size_t count, void* from) {
  auto& rest = static_cast<Upload*>(from)->rest;
  const std::size_t size = std::min(one * count, rest.size());
  std::memcpy(to, rest.data(), size);
  rest.remove_prefix(size);
  return size;
}

int show_progress(void* to, curl_off_t down_total, curl_off_t down, curl_off_t up_total, curl_off_t up) {
  const auto& progress = *static_cast<const Progress*>(to);
  const bool uploading = up_total > 0;
  if (progress) {
    progress(static_cast<std::size_t>(uploading ? up : down),
             static_cast<std::size_t>(uploading ? up_total : down_total));
  }
  return 0;
}

std::string header(CURL* curl, std::string_view name) {
  struct curl_header* found = nullptr;
  if (curl_easy_header(curl, std::string(name).c_str(), 0, CURLH_HEADER, -1, &found) != CURLHE_OK) return {};
  return contract_io::one_line(found->value);
}

HttpAnswer answer_of(CURL* curl, std::string body) {
  HttpAnswer answer;
  long status = 0;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
  answer.status = static_cast<int>(status);
  answer.body = std::move(body);
  answer.version = header(curl, kVersionHeader);
  const std::string retry = header(curl, "Retry-After");
  int seconds = 0;
  if (std::from_chars(retry.data(), retry.data() + retry.size(), seconds).ec == std::errc{}) {
    answer.retry_after_s = seconds;
  }
  return answer;
}

// Of the certificate that the other end showed, whether it was taken or not.
std::optional<Fingerprint> shown_fingerprint(CURL* curl) {
  curl_certinfo* chain = nullptr;
  if (curl_easy_getinfo(curl, CURLINFO_CERTINFO, &chain) != CURLE_OK || chain == nullptr) return std::nullopt;
  if (chain->num_of_certs < 1) return std::nullopt;
  constexpr std::string_view kCertificate = "Cert:";
  for (const curl_slist* line = chain->certinfo[0]; line != nullptr; line = line->next) {
    const std::string_view text = line->data;
    if (!text.starts_with(kCertificate)) continue;
    const auto found = fingerprint_of_certificate(text.substr(kCertificate.size()));
    return found ? std::optional(*found) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

struct HttpClient::Handle {
  explicit Handle(Address to) : address(std::move(to)), curl(curl_easy_init()) {
    if (curl == nullptr) throw std::bad_alloc();
    const auto set = [this](auto option, auto value) {
      if (curl_easy_setopt(curl, option, value) != CURLE_OK) throw std::runtime_error("libcurl lacks an option");
    };
    set(CURLOPT_PROTOCOLS_STR, "https");
    set(CURLOPT_PROXY, "");
    set(CURLOPT_FOLLOWLOCATION, 0L);
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
    // The key is compared instead of the name: the certificate is the appliance's own, signed by nobody else.
    set(CURLOPT_SSL_VERIFYPEER, 0L);
    set(CURLOPT_SSL_VERIFYHOST, 0L);
    set(CURLOPT_CERTINFO, 1L);
    set(CURLOPT_CONNECTTIMEOUT_MS, kConnect_ms);
    set(CURLOPT_TIMEOUT, kWhole_s);
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, kStalled_s);
    set(CURLOPT_ERRORBUFFER, &reason[0]);
    set(CURLOPT_WRITEFUNCTION, &take_body);
    set(CURLOPT_READFUNCTION, &give_body);
    set(CURLOPT_XFERINFOFUNCTION, &show_progress);
    set(CURLOPT_NOPROGRESS, 0L);
  }
  ~Handle() { curl_easy_cleanup(curl); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  Result<HttpAnswer> send(const HttpRequest& request, const Progress& progress);
  [[nodiscard]] std::unexpected<Error> failed(CURLcode code) const;

  Address address;
  std::optional<Fingerprint> expected;
  CURL* curl;
  char reason[CURL_ERROR_SIZE]{};
};

Result<HttpAnswer> HttpClient::Handle::send(const HttpRequest& request, const Progress& progress) {
  std::string body;
  Upload upload{request.body};
  Headers headers;
  add_header(headers, "Accept: */*");
  if (has_body(request.method)) add_header(headers, "Content-Type: " + std::string(request.content_type));
  if (!request.token.empty()) add_header(headers, "Authorization: Bearer " + request.token);
  curl_easy_setopt(curl, CURLOPT_URL, (address.url() + request.path).c_str());
  curl_easy_setopt(curl, CURLOPT_HTTPGET, 1L);
  if (has_body(request.method)) {
    curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
    curl_easy_setopt(curl, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
  }
  curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method_name(request.method));
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(curl, CURLOPT_READDATA, &upload);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &body);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, &progress);
  reason[0] = 0;
  const CURLcode code = curl_easy_perform(curl);
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, nullptr);
  if (code == CURLE_OK) return answer_of(curl, std::move(body));
  // An answer that came before all of the body was sent counts: a refusal ends the connection.
  auto early = answer_of(curl, std::move(body));
  if (code == CURLE_SEND_ERROR && early.status >= 400) return early;
  return failed(code);
}

std::unexpected<Error> HttpClient::Handle::failed(CURLcode code) const {
  const std::string where = address.text();
  if (code == CURLE_SSL_PINNEDPUBKEYNOTMATCH && expected) {
    const auto shown = shown_fingerprint(curl);
    return failure(ResultCode::kCertificateChanged,
                   "%s: expected the key %s, found %s; check on the appliance which is its own, then 'beltpick enrol' "
                   "anew with --fingerprint",
                   where.c_str(), expected->text().c_str(), shown ? shown->text().c_str() : "another one");
  }
  const std::string why = contract_io::one_line(reason[0] != 0 ? reason : curl_easy_strerror(code));
  const char* remedy = "check address and port, that beltpickd runs, and its [service] address";
  if (code == CURLE_COULDNT_RESOLVE_HOST) remedy = "check the name, or give the address";
  if (code == CURLE_SSL_CONNECT_ERROR) remedy = "check that beltpick's service, not something else, has this port";
  return failure(ResultCode::kServiceUnreachable, "%s: expected an appliance that answers, found: %s; %s",
                 where.c_str(), why.substr(0, 160).c_str(), remedy);
}

HttpClient::HttpClient(Address address, const Fingerprint& fingerprint)
    : handle_(std::make_unique<Handle>(std::move(address))) {
  handle_->expected = fingerprint;
  if (curl_easy_setopt(handle_->curl, CURLOPT_PINNEDPUBLICKEY, fingerprint.curl_pin().c_str()) != CURLE_OK) {
    throw std::runtime_error("libcurl cannot compare keys");
  }
}

HttpClient::HttpClient(HttpClient&&) noexcept = default;
HttpClient& HttpClient::operator=(HttpClient&&) noexcept = default;
HttpClient::~HttpClient() = default;

Result<HttpAnswer> HttpClient::send(const HttpRequest& request, const Progress& progress) {
  return handle_->send(request, progress);
}

Result<FirstContact> HttpClient::first_contact(const Address& address, const std::string& health_path) {
  Handle handle(address);
  auto health = handle.send({.path = health_path}, {});
  if (!health) return std::unexpected(health.error());
  const auto shown = shown_fingerprint(handle.curl);
  if (shown) return FirstContact{*shown, std::move(*health)};
  return failure(ResultCode::kServiceUnreachable, "%s: expected a certificate with a public key, found none",
                 address.text().c_str());
}

}  // namespace beltpick::link
