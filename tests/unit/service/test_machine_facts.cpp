// What the self-test finds out about the PC, against sockets and folders made for it.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "service/folder.hpp"
#include "service/listen_socket.hpp"
#include "service/machine_facts.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::service;
using beltpick::test::TempFolder;

TEST_CASE("an IPv6 address stands in brackets before a port") {
  CHECK(url_host("::") == "[::]");
  CHECK(url_host("fe80::1") == "[fe80::1]");
  CHECK(url_host("192.168.1.5") == "192.168.1.5");
}

TEST_CASE("a folder is tried and left as it was") {
  const TempFolder temp;
  const FolderFound found = find_folder(temp.path());
  CHECK(found.there);
  CHECK(found.writable);
  CHECK(found.free_bytes > 0);
  CHECK(std::filesystem::is_empty(temp.path()));

  const FolderFound missing = find_folder(temp.path() / "a" / "b");
  CHECK_FALSE(missing.there);
  CHECK(missing.writable);
  CHECK(std::filesystem::is_empty(temp.path()));

  std::ofstream(temp.path() / "file") << "x";
  const FolderFound below_file = find_folder(temp.path() / "file" / "state");
  CHECK_FALSE(below_file.writable);
  CHECK(below_file.problem.find("not a folder") != std::string::npos);
  CHECK_FALSE(find_folder("/proc/beltpick").writable);  // read-only for root too
}

TEST_CASE("a port is free, taken, or of no interface here") {
  auto listener = listen_on("127.0.0.1", 0);
  REQUIRE(listener);
  const int port = port_of(*listener);
  CHECK(find_port("127.0.0.1", port).state == PortState::kTaken);
  CHECK_FALSE(ask_daemon("127.0.0.1", port));  // connects, but says nothing
  *listener = Descriptor();
  CHECK(find_port("127.0.0.1", port).state == PortState::kFree);
  CHECK_FALSE(ask_daemon("127.0.0.1", port));
  const PortFound foreign = find_port("203.0.113.7", port);
  CHECK(foreign.state == PortState::kNoSuchAddress);
  CHECK(!foreign.problem.empty());
  CHECK(find_port("not an address", port).state == PortState::kNoSuchAddress);
}

TEST_CASE("the way to a loopback address is the loopback interface") {
  const InterfaceFound found = find_interface("127.0.7.7");
  CHECK(found.name == "lo");
  CHECK(found.mtu > 1000);
  CHECK(find_interface("no address").name.empty());
}

TEST_CASE("the kernel's answer about the socket buffer is what a socket gets") {
  const SocketBufferFound found = find_socket_buffer(100'000, 1000);
  CHECK(found.granted_bytes == 100'000);
}

TEST_CASE("a certificate that is not there, and one that is none") {
  const TempFolder temp;
  CHECK_FALSE(find_certificate(temp.path()).there);
  std::filesystem::create_directory(temp.path() / "tls");
  std::ofstream(temp.path() / "tls" / "certificate.pem") << "nonsense";
  const CertificateFound found = find_certificate(temp.path());
  CHECK(found.there);
  CHECK_FALSE(found.days_left);
}

TEST_CASE("the clock of a test machine is not before its programs") {
  const ClockFound clock = find_clock();
  CHECK(clock.now_s >= clock.not_before_s);
  CHECK(clock.not_before_s > 0);
}
