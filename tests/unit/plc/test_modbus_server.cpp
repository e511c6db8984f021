// The server against libmodbus' own client and against raw sockets that misbehave.
#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "base/clock.hpp"
#include "plc/modbus_server.hpp"

using namespace beltpick;
using namespace beltpick::plc;

namespace {

struct Served {
  PlcExchange exchange{WordOrder::kHighFirst};
  std::unique_ptr<ModbusServer> server;
  std::atomic<bool> stop{false};
  std::thread thread;

  explicit Served(ModbusServerConfig config = {}) {
    config.address = "127.0.0.1";
    config.port = 0;
    auto opened = ModbusServer::open(config, exchange);
    REQUIRE(opened);
    server = std::move(*opened);
    ApplianceRegisters registers;
    registers.cycle = 4321;
    exchange.publish(registers);
    thread = std::thread([this] {
      while (!stop) server->poll(5);
    });
  }
  ~Served() {
    stop = true;
    thread.join();
  }
};

struct RawClient {
  int socket = ::socket(AF_INET, SOCK_STREAM, 0);

  explicit RawClient(std::uint16_t port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(connect(socket, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
    timeval patience{3, 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~RawClient() { close(socket); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void say(const std::vector<std::uint8_t>& bytes) const {
    REQUIRE(send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()));
  }
  // What comes next; empty when the server hung up.
  [[nodiscard]] std::vector<std::uint8_t> hear() const {
    std::vector<std::uint8_t> bytes(300);
    const ssize_t got = recv(socket, bytes.data(), bytes.size(), 0);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
};

struct Client {
  modbus_t* context;
  explicit Client(std::uint16_t port) : context(modbus_new_tcp("127.0.0.1", port)) {
    modbus_set_response_timeout(context, 2, 0);
    REQUIRE(modbus_connect(context) == 0);
  }
  ~Client() {
    modbus_close(context);
    modbus_free(context);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  [[nodiscard]] int cycle() const {
    std::uint16_t value = 0;
    return modbus_read_input_registers(context, 8, 1, &value) == 1 ? value : -1;
  }
};

const std::vector<std::uint8_t> kReadOne{0, 9, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1};

}  // namespace

TEST_CASE("libmodbus' client reads and writes what the table promises", "[server]") {
  Served served;
  Client client(served.server->port());
  for (const int unit : {1, 0, 200, 255}) {
    modbus_set_slave(client.context, unit);
    CHECK(client.cycle() == 4321);
  }
  const std::uint16_t written[] = {0, 0, 3, 12};
  CHECK(modbus_write_registers(client.context, 0, 4, written) == 4);
  CHECK(modbus_write_register(client.context, 3, 13) == 1);
  std::uint16_t back[4] = {};
  CHECK(modbus_read_registers(client.context, 0, 4, back) == 4);
  CHECK((back[2] == 3 && back[3] == 13));
  const std::uint16_t more[] = {2, 14};
  CHECK(modbus_write_and_read_registers(client.context, 2, 2, more, 2, 2, back) == 2);
  CHECK((back[0] == 2 && back[1] == 14));
  CHECK(client.cycle() == 4321);  // one request later the write has reached the appliance
  CHECK(served.exchange.view().robot_clear);
  CHECK_FALSE(served.exchange.view().belt_stopped);
  CHECK(modbus_read_registers(client.context, 15, 2, back) == -1);
  CHECK(errno == EMBXILADD);
}

TEST_CASE("malformed requests get their exception at once and stall nobody", "[server]") {
  Served served;
  const RawClient rude(served.server->port());
  Client client(served.server->port());
  const std::vector<std::vector<std::uint8_t>> malformed{
      {0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 200},                  // too many registers
      {0, 2, 0, 0, 0, 6, 1, 99, 0, 0, 0, 1},                   // no such function
      {0, 3, 0, 0, 0, 3, 1, 16, 0},                            // cut short by its own length
      {0, 4, 0, 0, 0, 11, 1, 16, 0, 0, 0, 2, 9, 0, 0, 0, 0}};  // byte count that does not fit
  double worst_ms = 0;
  for (int round = 0; round < 25; ++round) {
    for (const auto& request : malformed) {
      rude.say(request);
      const Stopwatch watch;
      REQUIRE(client.cycle() == 4321);
      worst_ms = std::max(worst_ms, watch.elapsed_ms());
      const auto answer = rude.hear();
      REQUIRE(answer.size() == 9);
      CHECK(answer[1] == request[1]);
      CHECK(answer[7] == (request[7] | 0x80));
    }
  }
  // libmodbus alone would wait 500 ms; a busy machine's scheduling stays far below.
  CHECK(worst_ms < 250.0);
}

TEST_CASE("what is not Modbus is cut off; half a request delays nobody and is given up", "[server]") {
  Served served({.half_request_us = 300'000});
  const RawClient http(served.server->port());
  const std::string get = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";
  http.say({get.begin(), get.end()});
  CHECK(http.hear().empty());
  const RawClient slow(served.server->port());
  slow.say({0, 1, 0, 0, 0});
  Client client(served.server->port());
  CHECK(client.cycle() == 4321);
  CHECK(slow.hear().empty());  // hung up after half_request_us
}

TEST_CASE("requests in pieces and in bunches are answered one by one", "[server]") {
  Served served;
  const RawClient client(served.server->port());
  for (const std::uint8_t byte : kReadOne) {
    client.say({byte});
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(client.hear().size() == 11);
  std::vector<std::uint8_t> bunch;
  for (int i = 0; i < 40; ++i) bunch.insert(bunch.end(), kReadOne.begin(), kReadOne.end());
  client.say(bunch);
  std::size_t got = 0;
  while (got < 40 * 11) {
    const auto bytes = client.hear();
    REQUIRE_FALSE(bytes.empty());
    got += bytes.size();
  }
  CHECK(got == 40 * 11);
}

TEST_CASE("clients beyond the cap are turned away while the others work; idle ones give way", "[server]") {
  Served served({.max_clients = 3, .idle_us = 400'000});
  Client working(served.server->port());
  CHECK(working.cycle() == 4321);
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 2; ++i) idle.push_back(std::make_unique<RawClient>(served.server->port()));
  CHECK(working.cycle() == 4321);
  {
    const RawClient late(served.server->port());
    CHECK(late.hear().empty());
  }
  for (int i = 0; i < 30; ++i) {  // the working client stays young, the idle ones age
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    CHECK(working.cycle() == 4321);
  }
  const RawClient next(served.server->port());
  next.say(kReadOne);
  CHECK(next.hear().size() == 11);
  CHECK(working.cycle() == 4321);
}

TEST_CASE("clients that come and go by the hundred leave room", "[server]") {
  Served served({.max_clients = 4});
  for (int i = 0; i < 300; ++i) {
    const RawClient client(served.server->port());
    if (i % 3 == 0) client.say({1, 2, 3});
    if (i % 3 == 1) client.say(kReadOne);
  }
  // Those that the server has not even accepted yet still take its places for a moment.
  bool answers = false;
  for (int i = 0; i < 100 && !answers; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    Client client(served.server->port());
    answers = client.cycle() == 4321;
  }
  CHECK(answers);
}

TEST_CASE("a port that is taken is named", "[server]") {
  Served served;
  PlcExchange exchange(WordOrder::kHighFirst);
  const auto second = ModbusServer::open({.address = "127.0.0.1", .port = served.server->port()}, exchange);
  REQUIRE_FALSE(second);
  CHECK(second.error().text().find("cannot be opened") != std::string_view::npos);
  const auto third = ModbusServer::open({.address = "not an address", .port = 0}, exchange);
  REQUIRE_FALSE(third);
}
