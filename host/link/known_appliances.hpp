// KnownAppliances: what this user keeps of each appliance: the key it must show, and the token it gave.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "link/address.hpp"
#include "link/fingerprint.hpp"

namespace beltpick::link {

struct KnownAppliance {
  Address address;
  Fingerprint fingerprint;
  std::string token;  // a secret
  std::string name;   // the token's, as the appliance lists it
  std::string role;
  std::string enrolled_utc;  // ISO 8601
};

class KnownAppliances {
 public:
  explicit KnownAppliances(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // ${XDG_CONFIG_HOME:-~/.config}/beltpick/appliances. Error: kFileNotFound where neither is known.
  static Result<KnownAppliances> of_this_user();

  [[nodiscard]] std::filesystem::path file(const Address& address) const;
  // Errors: kNotEnrolled; kFileUnreadable, also where others may read the file; those of a malformed file.
  [[nodiscard]] Result<KnownAppliance> find(const Address& address) const;
  // Sees that keep() can write: a one-time token works once. Error: kFileNotWritten.
  [[nodiscard]] Result<void> prepare() const;
  // Error: kFileNotWritten.
  [[nodiscard]] Result<void> keep(const KnownAppliance& appliance) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace beltpick::link
