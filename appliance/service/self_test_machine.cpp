// The self-test's checks of the PC: ports, folders, clock, limits, certificate.
#include "service/self_test_checks.hpp"

namespace beltpick::service {

namespace {

constexpr std::int64_t kMegabyte = 1'000'000;
constexpr std::int64_t kTooLittle = 50 * kMegabyte;  // a store of ten versions needs some 10 MB
constexpr std::int64_t kLittle = 500 * kMegabyte;
constexpr double kWarnDays = 90.0;
constexpr std::int64_t kTenYears_s = std::int64_t{10} * 366 * 86400;

// Of a port that cannot be served; nothing where all is well with it.
std::optional<Check> port_problem(const char* name, const PortFound& port, const char* setting) {
  const std::string at = text("port %d on %s", port.port, port.address.c_str());
  switch (port.state) {
    case PortState::kTaken:
      return not_good(
          Verdict::kFailed, name, at + " is taken", "another program listens there",
          text("find it with 'ss -ltnp sport = :%d' and end it, or choose another %s.port", port.port, setting));
    case PortState::kForbidden:
      return not_good(Verdict::kFailed, name, at + " may not be opened",
                      "ports below 1024 need CAP_NET_BIND_SERVICE, which this process does not have",
                      "run as the service does (systemctl start beltpickd) or test with sudo, or choose another port");
    case PortState::kNoSuchAddress:
      return not_good(Verdict::kFailed, name, at + " cannot be opened: " + port.problem,
                      "no network interface of this PC has that address",
                      text("correct %s.address, or set the interface's address", setting));
    default:
      return std::nullopt;
  }
}

}  // namespace

Check check_plc_port(const PortFound& port) {
  constexpr const char* kName = "PLC port";
  if (auto problem = port_problem(kName, port, "plc")) return *problem;
  const char* address = port.address.c_str();
  if (port.state == PortState::kServedByDaemon) {
    return good(kName, "port %d on %s is served by the running beltpickd", port.port, address);
  }
  if (port.state == PortState::kFree) return good(kName, "port %d on %s is free", port.port, address);
  if (port.connected) return good(kName, "port %d on %s is served, a PLC is connected", port.port, address);
  return not_good(Verdict::kWarning, kName, text("port %d on %s is served, no PLC is connected", port.port, address),
                  "the PLC has not connected",
                  "check the address of this PC in the PLC's program, the cable, and a firewall between them");
}

Check check_folder(const char* name, const FolderFound& folder, const char* without) {
  if (!folder.configured) return skipped(name, "%s", without);
  const char* path = folder.path.c_str();
  if (!folder.writable) {
    const char* what = folder.there ? "cannot be written" : "is not there and cannot be made";
    return not_good(
        Verdict::kFailed, name, text("%s %s", path, what), folder.problem,
        text("chown beltpick %s, or mount the disk for writing; check the disk if it was writable before", path));
  }
  const std::string found = text("%s%s, %.1f GB free", path, folder.there ? "" : " is made at the first start",
                                 static_cast<double>(folder.free_bytes) / 1e9);
  if (folder.free_bytes < kLittle) {
    return not_good(folder.free_bytes < kTooLittle ? Verdict::kFailed : Verdict::kWarning, name, found,
                    "the disk is nearly full", "delete old records or logs, or lower record.keep");
  }
  return good(name, "%s", found.c_str());
}

Check check_clock(const ClockFound& clock) {
  constexpr const char* kName = "clock";
  if (clock.now_s < clock.not_before_s || clock.now_s > clock.not_before_s + kTenYears_s) {
    return not_good(Verdict::kFailed, kName, "not plausible: it does not fit the time when beltpickd was installed",
                    "the clock is wrong: a flat battery, or never set",
                    "set it: timedatectl set-ntp true, or timedatectl set-time");
  }
  if (!clock.synchronised) return good(kName, "plausible; the system does not tell whether it is synchronised");
  if (*clock.synchronised) return good(kName, "synchronised");
  return not_good(
      Verdict::kWarning, kName, "plausible, not synchronised", "no time server is reached",
      "name one of the plant's in /etc/systemd/timesyncd.conf; times in logs and versions drift without it");
}

Check check_memory(const MemoryFound& memory) {
  constexpr const char* kName = "memory lock";
  const std::string found = text("%.1f MB taken at start", static_cast<double>(memory.bytes) / 1e6);
  if (memory.locked) return good(kName, "%s, locked", found.c_str());
  return not_good(Verdict::kWarning, kName, found + ", not locked", "the limit of locked memory (memlock) is lower",
                  "start it as the service, whose unit raises it (LimitMEMLOCK=), or raise 'ulimit -l'");
}

Check check_realtime(bool allowed) {
  constexpr const char* kName = "real-time";
  if (allowed) return good(kName, "camera, trigger, PLC and cycle get real-time priority");
  return not_good(Verdict::kWarning, kName, "no real-time priority", "the limit of real-time priority (rtprio) is 0",
                  "start it as the service, whose unit raises it (LimitRTPRIO=), or raise 'ulimit -r'");
}

Check check_service(const PortFound& port, const CertificateFound& certificate) {
  constexpr const char* kName = "service";
  if (!certificate.expected) return skipped(kName, "the HTTPS service is off (service.state or service.enabled)");
  if (auto problem = port_problem(kName, port, "service")) return *problem;
  const char* address = port.address.c_str();
  const char* how = port.state == PortState::kFree ? "is free" : "is served";
  if (!certificate.there) {
    return good(kName, "port %d on %s %s; its certificate is made at the first start", port.port, address, how);
  }
  if (!certificate.days_left) {
    return not_good(Verdict::kFailed, kName, text("port %d on %s %s", port.port, address, how),
                    "the certificate in the state folder cannot be read",
                    "restore tls/ from a backup, or remove it: a new one is made, and every client enrols again");
  }
  const std::string found =
      text("port %d on %s %s, certificate good for %.0f days", port.port, address, how, *certificate.days_left);
  if (*certificate.days_left > kWarnDays) return good(kName, "%s", found.c_str());
  return not_good(*certificate.days_left <= 0 ? Verdict::kFailed : Verdict::kWarning, kName, found,
                  "the certificate ends", "remove tls/ in the state folder, restart, and enrol every client again");
}

}  // namespace beltpick::service
