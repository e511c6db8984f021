#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "capture/receive_buffer.hpp"

namespace {
int receive_bytes(int fd) {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  REQUIRE(::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, &size) == 0);
  return bytes;
}
}  // namespace

TEST_CASE("the socket at the port gets another buffer, a neighbour keeps its own", "[receive buffer]") {
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  const int neighbour = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(::bind(neighbour, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  socklen_t size = sizeof address;
  REQUIRE(::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0);
  const int before = receive_bytes(neighbour);
  // Smaller than any default, so that no limit of the machine is in the way; the kernel doubles what it is told.
  beltpick::capture::enlarge_receive_buffer(ntohs(address.sin_port), 20000);
  CHECK(receive_bytes(fd) == 40000);
  CHECK(receive_bytes(neighbour) == before);
  ::close(fd);
  ::close(neighbour);
}
