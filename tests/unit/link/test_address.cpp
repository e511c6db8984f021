#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "link/address.hpp"
#include "link/reach.hpp"

using namespace beltpick;
using link::Address;

TEST_CASE("An address is read in each of its forms", "[link]") {
  struct Case {
    const char* written;
    const char* host;
    unsigned port;
    const char* text;
    const char* url;
  };
  const auto c = GENERATE(values<Case>({
      {"cell4", "cell4", 8443, "cell4:8443", "https://cell4:8443"},
      {"Cell4.Example.COM:9000", "cell4.example.com", 9000, "cell4.example.com:9000", "https://cell4.example.com:9000"},
      {"192.168.1.20", "192.168.1.20", 8443, "192.168.1.20:8443", "https://192.168.1.20:8443"},
      {"192.168.1.20:1", "192.168.1.20", 1, "192.168.1.20:1", "https://192.168.1.20:1"},
      {"::1", "::1", 8443, "[::1]:8443", "https://[::1]:8443"},
      {"[::1]", "::1", 8443, "[::1]:8443", "https://[::1]:8443"},
      {"[::1]:65535", "::1", 65535, "[::1]:65535", "https://[::1]:65535"},
      {"[2001:DB8:0:0:0:0:0:7]:443", "2001:db8::7", 443, "[2001:db8::7]:443", "https://[2001:db8::7]:443"},
      {"[fe80::1%eth0]:9", "fe80::1%eth0", 9, "[fe80::1%eth0]:9", "https://[fe80::1%25eth0]:9"},
      {"a_b-c.d:2", "a_b-c.d", 2, "a_b-c.d:2", "https://a_b-c.d:2"},
  }));
  const auto address = link::parse_address(c.written);
  INFO(c.written);
  REQUIRE(address);
  CHECK(address->host == c.host);
  CHECK(address->port == c.port);
  CHECK(address->text() == c.text);
  CHECK(address->url() == c.url);
  CHECK(link::parse_address(address->text()) == *address);
  CHECK(address->file_stem().find('/') == std::string::npos);
}

TEST_CASE("What is no address is refused as wrong usage", "[link]") {
  const std::string text =
      GENERATE(as<std::string>{}, "", ":", ":8443", "cell4:", "cell4:0", "cell4:65536", "cell4:-1", "cell4:84x",
               "cell4: 1", "cell 4", "https://cell4", "https://cell4:8443/", "cell4/..", "user@cell4", "..", "../x",
               "-cell4", "[::1", "::1]", "[::1]8443", "[::1]:", "[cell4]:1", "1:2:3", "::g", "[fe80::1%]:1",
               "[fe80::1%a/b]:1", "c\xc3\xa9ll", "cell\n4", "cell4:+1", "cell4:1e3");
  const auto address = link::parse_address(text);
  INFO(text);
  REQUIRE_FALSE(address);
  CHECK(address.error().code == ResultCode::kUsage);
  CHECK(address.error().text().find('\n') == std::string_view::npos);
}

TEST_CASE("A name of any length is read or refused, never cut", "[link]") {
  CHECK(link::parse_address(std::string(253, 'a')));
  CHECK_FALSE(link::parse_address(std::string(254, 'a')));
  CHECK_FALSE(link::parse_address(std::string(100000, ':')));
}

TEST_CASE("A host that is there resolves, a port that is closed is told apart", "[link]") {
  const auto found = link::resolve({"127.0.0.1", 1});
  REQUIRE(found);
  CHECK(*found == std::vector<std::string>{"127.0.0.1"});
  CHECK_FALSE(link::resolve({"no-such-host.invalid", 1}));
  const auto closed = link::knock({"127.0.0.1", 1}, 1000);
  REQUIRE_FALSE(closed);
  CHECK(closed.error().code == ResultCode::kServiceUnreachable);
  CHECK(closed.error().text().find("127.0.0.1:1") != std::string_view::npos);
}
