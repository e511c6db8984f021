// What a request's head alone decides: rate, route, token, role, length, type; and the bound on the log.
#include <arpa/inet.h>
#include <netinet/in.h>

#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "service/gate.hpp"
#include "service/service_log.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::service;
using namespace beltpick::test;

namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

ClientAddress address_of(const char* text) {
  sockaddr_in6 v6{};
  sockaddr_in v4{};
  if (inet_pton(AF_INET, text, &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    return client_address(reinterpret_cast<const sockaddr*>(&v4));
  }
  REQUIRE(inet_pton(AF_INET6, text, &v6.sin6_addr) == 1);
  v6.sin6_family = AF_INET6;
  return client_address(reinterpret_cast<const sockaddr*>(&v6));
}

// A gate, and a token of each role.
struct Bench {
  explicit Bench(int requests_per_minute = 100'000) : addresses(requests_per_minute) {
    for (const Role role : {Role::kViewer, Role::kOperator, Role::kCommissioner}) {
      tokens[static_cast<std::size_t>(role)] = "Bearer " + *book.make(std::string(role_name(role)), role);
    }
  }

  static TokenBook open(const std::filesystem::path& path) {
    std::vector<std::string> notes;
    return std::move(*TokenBook::open(std::move(*Folder::make(path)), notes));
  }

  RequestHead head(std::string_view method, std::string_view path, Role role) const {
    RequestHead head;
    head.method = method;
    head.path = path;
    head.authorization = tokens[static_cast<std::size_t>(role)];
    return head;
  }
  unsigned status(const RequestHead& head, std::int64_t at_us = kSecond_us) {
    const Admission admission = gate.judge(head, from, at_us);
    return admission.refused ? admission.refused->status : 200;
  }

  TempFolder folder;
  TokenBook book = open(folder.path());
  AddressBook addresses;
  Gate gate{book, addresses};
  std::array<std::string, 4> tokens;
  ClientAddress from = address_of("192.168.0.7");
};

}  // namespace

TEST_CASE("a full disk is the disk's trouble, not the service's") {
  CHECK(http_status(ResultCode::kDiskFull) == 507);
  CHECK(http_status(ResultCode::kFileNotWritten) == 500);
}

TEST_CASE("each role may do what its routes say, and no more", "[gate]") {
  Bench bench;
  for (const ApiRoute& route : kApiRoutes) {
    std::string path(route.path);
    if (const auto at = path.find("{kind}"); at != std::string::npos) path.replace(at, 6, "template");
    if (const auto at = path.find("{name}"); at != std::string::npos) path.replace(at, 6, "knuckle");
    if (const auto at = path.find("{version}"); at != std::string::npos) path.replace(at, 9, "3");
    for (const Role role : {Role::kNobody, Role::kViewer, Role::kOperator, Role::kCommissioner}) {
      RequestHead head = bench.head(method_name(route.method), path, role);
      if (route.method == HttpMethod::kPut) head.content_length = "10";
      INFO(head.method << " " << path << " as " << role_name(role));
      const unsigned refused = role == Role::kNobody ? 401 : 403;
      CHECK(bench.status(head) == (role >= route.role ? 200 : refused));
    }
  }
}

TEST_CASE("a body's length and type are judged before it comes", "[gate]") {
  Bench bench;
  RequestHead head = bench.head("PUT", "/api/v1/items/template/knuckle", Role::kCommissioner);
  CHECK(bench.status(head) == 411);
  head.content_length = "4194304";
  CHECK(bench.status(head) == 200);
  head.content_length = "4194305";
  CHECK(bench.status(head) == 413);
  for (const char* wrong : {"-1", "1e3", " 12", "0x10", "99999999999999999999999", "12,12", "+3"}) {
    head.content_length = wrong;
    INFO(wrong);
    CHECK(bench.status(head) == 400);
  }
  head.content_length = "12";
  head.doubled = true;
  CHECK(bench.status(head) == 400);
  head.doubled = false;
  head.transfer_encoding = true;
  CHECK(bench.status(head) == 411);
  head.transfer_encoding = false;
  head.content_type = "application/x-www-form-urlencoded";
  CHECK(bench.status(head) == 415);
  head.content_type = "application/octet-stream";
  CHECK(bench.status(head) == 200);

  RequestHead token = bench.head("POST", "/api/v1/tokens", Role::kCommissioner);
  token.content_length = "4096";
  token.content_type = "application/json; charset=utf-8";
  CHECK(bench.status(token) == 200);
  token.content_length = "4097";
  CHECK(bench.status(token) == 413);
  RequestHead look = bench.head("GET", "/api/v1/status", Role::kViewer);
  look.content_length = "1";
  CHECK(bench.status(look) == 413);
}

TEST_CASE("five wrong tokens in a minute lock an address out for the rest of it", "[gate]") {
  Bench bench;
  RequestHead wrong = bench.head("GET", "/api/v1/status", Role::kNobody);
  wrong.authorization = "Bearer 0123";
  const RequestHead right = bench.head("GET", "/api/v1/status", Role::kViewer);
  const RequestHead enrol = bench.head("POST", "/api/v1/enrol", Role::kNobody);
  for (int i = 0; i < AddressBook::kWrongTokens; ++i) {
    CHECK(bench.status(right, kSecond_us * (1 + i)) == 200);
    CHECK(bench.status(wrong, kSecond_us * (1 + i)) == 401);
  }
  const Admission locked = bench.gate.judge(wrong, bench.from, kSecond_us * 10);
  REQUIRE(locked.refused);
  CHECK(locked.refused->status == 429);
  CHECK(locked.refused->retry_after_s > 40);
  CHECK(locked.refused->retry_after_s <= 60);
  CHECK(bench.status(right, kSecond_us * 10) == 429);
  CHECK(bench.status(enrol, kSecond_us * 10) == 429);
  CHECK(bench.status(bench.head("GET", "/api/v1/health", Role::kNobody), kSecond_us * 10) == 200);
  bench.from = address_of("192.168.0.8");
  CHECK(bench.status(right, kSecond_us * 10) == 200);
  bench.from = address_of("192.168.0.7");
  CHECK(bench.status(right, kSecond_us * 62) == 200);
}

TEST_CASE("an address may ask so often a minute, whatever the others do", "[gate]") {
  Bench bench(60);
  const RequestHead head = bench.head("GET", "/api/v1/health", Role::kNobody);
  for (int i = 0; i < 60; ++i) CHECK(bench.status(head) == 200);
  CHECK(bench.status(head) == 429);
  CHECK(bench.status(head, kSecond_us * 2) == 200);  // one a second comes back
  CHECK(bench.status(head, kSecond_us * 2) == 429);
  bench.from = address_of("10.0.0.1");
  CHECK(bench.status(head, kSecond_us * 2) == 200);
}

TEST_CASE("addresses: IPv4 in either form is one, an IPv6 network is one, and the book is bounded", "[gate]") {
  CHECK(address_of("10.1.2.3") == address_of("::ffff:10.1.2.3"));
  CHECK(address_of("2001:db8:1:2::5") == address_of("2001:db8:1:2:3:4:5:6"));
  CHECK_FALSE(address_of("2001:db8:1:2::5") == address_of("2001:db8:1:3::5"));
  CHECK(address_text(address_of("10.1.2.3")) == "10.1.2.3");
  CHECK(address_text(address_of("2001:db8:1:2::5")) == "2001:db8:1:2::/64");

  AddressBook book(10);
  const ClientAddress first = address_of("10.1.2.3");
  for (int i = 0; i < 11; ++i) (void)book.ask(first, kSecond_us);
  CHECK(book.ask(first, kSecond_us) > 0);
  for (std::uint32_t i = 0; i < AddressBook::kAddresses - 1; ++i) {
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_addr.s_addr = htonl(0x0B000000U + i);
    CHECK(book.ask(client_address(reinterpret_cast<const sockaddr*>(&v4)), kSecond_us + 1 + i) == 0);
  }
  CHECK(book.ask(first, kSecond_us + 500) > 0);  // still remembered
}

TEST_CASE("refusals do not flood the log", "[gate]") {
  std::vector<std::string> lines;
  RefusalLog log([&](bool warning, const std::string& line) {
    CHECK(warning);
    lines.push_back(line);
  });
  for (int i = 0; i < 1000; ++i) log.write("refused", 20 * kSecond_us + i);
  CHECK(lines.size() == RefusalLog::kLines);
  log.settle(31 * kSecond_us);
  REQUIRE(lines.size() == RefusalLog::kLines + 1);
  CHECK(lines.back().find("990 more") != std::string::npos);
  log.write("refused", 31 * kSecond_us);
  CHECK(lines.back() == "refused");
}
