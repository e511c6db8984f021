#include "service/secrets.hpp"

#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>

#include <array>
#include <cstring>
#include <stdexcept>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "service/sha256.hpp"

namespace beltpick::service {
namespace {

constexpr mode_t kOwnerOnly = 0600;

Result<void> outcome(const std::string& name, int error) {
  if (error == 0) return {};
  return failure(contract_io::write_error_code(error),
                 "%s in the state folder: expected to write it, found: %s; check the folder, its permissions and the "
                 "free space",
                 name.c_str(), std::strerror(error));
}

}  // namespace

std::string random_token() {
  std::array<char, 32> bits{};
  if (gnutls_rnd(GNUTLS_RND_KEY, bits.data(), bits.size()) != 0) throw std::runtime_error("no random numbers");
  return sha256_hex({bits.data(), bits.size()});
}

bool same_secret(std::string_view a, std::string_view b) {
  return a.size() == b.size() && gnutls_memcmp(a.data(), b.data(), a.size()) == 0;
}

Result<void> write_secret(const Folder& folder, const std::string& name, std::string_view bytes) {
  int error = folder.write(name + ".new", name + ".part", bytes, "", kOwnerOnly);
  if (error == 0) error = folder.rename(name + ".new", name);
  if (error == 0) error = folder.sync();
  return outcome(name, error);
}

Result<void> remove_secret(const Folder& folder, const std::string& name) {
  const int error = folder.remove(name);
  return outcome(name, error == 0 ? folder.sync() : error);
}

}  // namespace beltpick::service
