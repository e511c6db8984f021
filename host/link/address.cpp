#include "link/address.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::link {
namespace {

constexpr std::size_t kMaxHost = 253;  // of a name in the DNS
constexpr std::string_view kScopeCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";  // of an interface behind '%'

bool is_ipv6(const std::string& host) { return host.find(':') != std::string::npos; }

bool is_name(std::string_view host) {
  const auto inside = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
  };
  return !host.empty() && host.size() <= kMaxHost && host.front() != '-' && host.front() != '.' &&
         std::all_of(host.begin(), host.end(), inside);
}

// The address in its shortest form; nothing where it is none.
std::optional<std::string> ipv6(std::string_view text) {
  const std::size_t percent = text.find('%');
  const std::string_view scope = percent == std::string_view::npos ? std::string_view() : text.substr(percent);
  if (!scope.empty() && (scope.size() < 2 || scope.find_first_not_of(kScopeCharacters, 1) != std::string_view::npos)) {
    return std::nullopt;
  }
  in6_addr address{};
  char shortest[INET6_ADDRSTRLEN];
  if (inet_pton(AF_INET6, std::string(text.substr(0, percent)).c_str(), &address) != 1 ||
      inet_ntop(AF_INET6, &address, shortest, sizeof shortest) == nullptr) {
    return std::nullopt;
  }
  return shortest + std::string(scope);
}

std::optional<std::uint16_t> port_number(std::string_view text) {
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc{} || end != text.data() + text.size() || port == 0 || port > 65535) return std::nullopt;
  return static_cast<std::uint16_t>(port);
}

std::optional<std::string> host_of(std::string_view text, bool bracketed) {
  if (bracketed) return ipv6(text);
  std::string host(text);
  std::transform(host.begin(), host.end(), host.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  return is_name(host) ? std::optional(host) : std::nullopt;
}

// Host and port as written; `port` is empty where none is.
struct Split {
  std::string_view host, port;
  bool bracketed = false;
  bool has_port = false;
};

std::optional<Split> split(std::string_view text) {
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) return std::nullopt;
    const std::string_view rest = text.substr(close + 1);
    if (!rest.empty() && rest.front() != ':') return std::nullopt;
    return Split{text.substr(1, close - 1), rest.empty() ? rest : rest.substr(1), true, !rest.empty()};
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return Split{text, {}, false, false};
  if (text.find(':', colon + 1) != std::string_view::npos) return Split{text, {}, true, false};
  return Split{text.substr(0, colon), text.substr(colon + 1), false, true};
}

}  // namespace

std::string Address::text() const { return (is_ipv6(host) ? "[" + host + "]" : host) + ":" + std::to_string(port); }

std::string Address::url() const {
  std::string escaped = host;
  if (const std::size_t percent = escaped.find('%'); percent != std::string::npos) escaped.insert(percent + 1, "25");
  return "https://" + Address{escaped, port}.text();
}

std::string Address::file_stem() const { return host + "_" + std::to_string(port); }

Result<Address> parse_address(std::string_view text) {
  const auto parts = split(text);
  const auto host = parts ? host_of(parts->host, parts->bracketed) : std::nullopt;
  const auto port = parts && parts->has_port ? port_number(parts->port) : kDefaultServicePort;
  if (host && port) return Address{*host, *port};
  return failure(ResultCode::kUsage,
                 "--to: expected HOST, HOST:PORT or [IPV6]:PORT such as cell4.local:8443, without https://, found '%s'",
                 contract_io::one_line(text).substr(0, 80).c_str());
}

}  // namespace beltpick::link
