// What the client does where no appliance answers; against a real one see tests/e2e/link.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "contract/result_codes.hpp"
#include "link/appliance.hpp"

using namespace beltpick;

namespace {

// Takes connections on a free port and answers each with `bytes`, whatever is asked.
class PlainServer {
 public:
  explicit PlainServer(std::string bytes) : bytes_(std::move(bytes)), socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(bind(socket_, reinterpret_cast<sockaddr*>(&place), sizeof place) == 0);
    REQUIRE(listen(socket_, 4) == 0);
    socklen_t size = sizeof place;
    REQUIRE(getsockname(socket_, reinterpret_cast<sockaddr*>(&place), &size) == 0);
    port = ntohs(place.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~PlainServer() {
    stop_ = true;
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
  }

  std::uint16_t port = 0;
  std::atomic<int> connections{0};

 private:
  void serve() {
    while (!stop_) {
      const int client = accept(socket_, nullptr, nullptr);
      if (client < 0) continue;
      ++connections;
      char asked[4096];
      (void)!read(client, asked, sizeof asked);
      (void)!write(client, bytes_.data(), bytes_.size());
      close(client);
    }
  }

  std::string bytes_;
  int socket_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace

TEST_CASE("Routes are filled from the contract's table", "[link]") {
  CHECK(link::route_path(ApiAction::kHealth) == "/api/v1/health");
  CHECK(link::route_path(ApiAction::kDownloadVersion, {"template", "knuckle", "3"}) ==
        "/api/v1/items/template/knuckle/versions/3");
  for (const ApiRoute& route : kApiRoutes) {
    CHECK(link::route_path(route.action, {"template", "knuckle", "3"}).find('{') == std::string::npos);
  }
}

TEST_CASE("A closed port is unreachable, in one line with the address", "[link]") {
  const auto contact = link::HttpClient::first_contact({"127.0.0.1", 1}, "/api/v1/health");
  REQUIRE_FALSE(contact);
  CHECK(contact.error().code == ResultCode::kServiceUnreachable);
  CHECK(contact.error().text().find("127.0.0.1:1: ") == 0);
}

TEST_CASE("A server that does not speak TLS is unreachable, whatever it says", "[link]") {
  for (const char* bytes : {"", "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}", "\x16\x03\x03\xff\xff junk"}) {
    PlainServer server(bytes);
    link::HttpClient client({"127.0.0.1", server.port}, {});
    const auto answer = client.send({.path = "/api/v1/status", .token = "secret"});
    REQUIRE_FALSE(answer);
    CHECK(answer.error().code == ResultCode::kServiceUnreachable);
  }
}

TEST_CASE("A proxy in the environment is not asked", "[link]") {
  PlainServer proxy("HTTP/1.1 502 no\r\nContent-Length: 0\r\n\r\n");
  const std::string url = "http://127.0.0.1:" + std::to_string(proxy.port);
  for (const char* name : {"https_proxy", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"}) setenv(name, url.c_str(), 1);
  CHECK_FALSE(link::HttpClient::first_contact({"127.0.0.2", 1}, "/"));
  for (const char* name : {"https_proxy", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"}) unsetenv(name);
  CHECK(proxy.connections == 0);
}
