#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>
#include <string>

#include "app/service_notify.hpp"
#include "app/watchdog.hpp"

using namespace beltpick::app;

TEST_CASE("the watchdog names the thread that stopped, each by its own limit", "[watchdog]") {
  Watchdog watchdog;
  auto& quick = watchdog.add("quick", 100, 0);
  auto& slow = watchdog.add("slow", 5000, 0);
  CHECK(watchdog.hung(50'000) == nullptr);
  slow(60'000);
  REQUIRE(watchdog.hung(150'000) != nullptr);
  CHECK(std::string(watchdog.hung(150'000)) == "quick");
  quick(150'000);
  CHECK(watchdog.hung(200'000) == nullptr);
  quick(6'000'000);
  CHECK(std::string(watchdog.hung(6'050'000)) == "slow");
}

TEST_CASE("the service manager hears what it is told", "[notify]") {
  const std::string path = "/tmp/beltpick_notify_" + std::to_string(getpid());
  const int listener = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::strncpy(at.sun_path, path.c_str(), sizeof at.sun_path - 1);
  REQUIRE(bind(listener, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  setenv("WATCHDOG_USEC", "3000000", 1);
  ServiceNotify notify;
  CHECK(notify.watchdog_us() == 1'500'000);
  notify.tell("READY=1");
  char heard[32] = {};
  CHECK(recv(listener, heard, sizeof heard, MSG_DONTWAIT) == 7);
  CHECK(std::string(heard) == "READY=1");
  char told[400] = {};
  notify.tell_state(beltpick::CellState::kFault, beltpick::ResultCode::kEmergencyStop);
  notify.tell_state(beltpick::CellState::kFault, beltpick::ResultCode::kEmergencyStop);
  CHECK(recv(listener, told, sizeof told - 1, MSG_DONTWAIT) > 0);
  CHECK(std::string(told).starts_with("STATUS=fault: 113 EMERGENCY_STOP: "));
  CHECK(recv(listener, told, sizeof told, MSG_DONTWAIT) == -1);  // said once
  close(listener);
  unlink(path.c_str());
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
}
