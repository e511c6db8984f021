#include "service/machine_facts.hpp"

#include <fcntl.h>
#include <gnutls/x509.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <thread>

#include "base/thread_priority.hpp"

namespace beltpick::service {

namespace {

constexpr std::size_t kMaxCertificate = std::size_t{1} << 16U;

// Empty where a file can be made in `folder`, else the system's words.
std::string write_problem(const std::filesystem::path& folder) {
  std::string name = (folder / ".self-test-XXXXXX").string();
  const int fd = ::mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) return std::strerror(errno);
  const bool whole = ::write(fd, "beltpick\n", 9) == 9 && ::fsync(fd) == 0;
  const int error = errno;
  ::close(fd);
  ::unlink(name.c_str());
  return whole ? "" : std::strerror(error);
}

// When this program was put where it is; 0 where the system does not tell.
std::int64_t installed_s() {
  struct stat found {};
  return ::stat("/proc/self/exe", &found) == 0 ? found.st_mtime : 0;
}

std::optional<bool> clock_synchronised() {
  timex clock{};
  const int state = ::adjtimex(&clock);
  if (state >= 0) return state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0;
  // The service's unit forbids the call, together with setting the clock; systemd-timesyncd leaves a file as well.
  std::error_code none;
  if (std::filesystem::exists("/run/systemd/timesync/synchronized", none)) return true;
  if (std::filesystem::exists("/run/systemd/timesync", none)) return false;
  return std::nullopt;
}

}  // namespace

FolderFound find_folder(const std::filesystem::path& path) {
  FolderFound found;
  found.configured = true;
  found.path = path.string();
  std::error_code none;
  found.there = std::filesystem::is_directory(path, none);
  std::filesystem::path existing = path;
  while (!std::filesystem::exists(existing, none) && existing.has_relative_path()) existing = existing.parent_path();
  if (!std::filesystem::is_directory(existing, none)) {
    found.problem = existing.string() + " is not a folder";
    return found;
  }
  found.problem = write_problem(existing);
  found.writable = found.problem.empty();
  struct statvfs disk {};
  if (::statvfs(existing.c_str(), &disk) == 0) {
    found.free_bytes = static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
  }
  return found;
}

ClockFound find_clock() { return {std::time(nullptr), installed_s(), clock_synchronised()}; }

// A thread of its own: the caller keeps the priority that it has.
bool realtime_allowed() {
  bool allowed = false;
  std::thread([&allowed] { allowed = make_realtime(RealtimePriority::kStream); }).join();
  return allowed;
}

CertificateFound find_certificate(const std::filesystem::path& state) {
  CertificateFound found;
  std::ifstream file(state / "tls" / "certificate.pem", std::ios::binary);
  found.there = file.is_open();
  std::string pem(std::istreambuf_iterator<char>(file), {});
  if (pem.empty() || pem.size() > kMaxCertificate) return found;
  gnutls_x509_crt_t certificate = nullptr;
  if (gnutls_x509_crt_init(&certificate) < 0) return found;
  const gnutls_datum_t bytes{reinterpret_cast<unsigned char*>(pem.data()), static_cast<unsigned>(pem.size())};
  if (gnutls_x509_crt_import(certificate, &bytes, GNUTLS_X509_FMT_PEM) == 0) {
    const std::time_t end = gnutls_x509_crt_get_expiration_time(certificate);
    found.days_left = std::difftime(end, std::time(nullptr)) / 86400.0;
  }
  gnutls_x509_crt_deinit(certificate);
  return found;
}

}  // namespace beltpick::service
