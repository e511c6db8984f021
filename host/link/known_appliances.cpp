#include "link/known_appliances.hpp"

#include <pwd.h>
#include <unistd.h>

#include <cstdlib>

#include "contract/result_codes.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"
#include "link/private_file.hpp"

namespace beltpick::link {
namespace {

constexpr const char* kFormat = "beltpick-appliance";
constexpr int kVersion = 1;

// What the environment or the user database says of the home folder; empty where neither knows.
std::filesystem::path home_folder() {
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') return home;
  const passwd* user = getpwuid(geteuid());
  return user != nullptr && user->pw_dir != nullptr ? user->pw_dir : "";
}

Result<KnownAppliance> parse(const std::string& text, const std::string& name, const Address& address) {
  contract_io::Warnings warnings;  // members of a later version do no harm
  contract_io::JsonDocument document(text, name, warnings);
  contract_io::JsonObject root = document.root({kFormat}, kVersion);
  KnownAppliance known;
  known.address = address;
  const std::string fingerprint = root.text("fingerprint");
  known.token = root.text("token");
  known.name = root.text("name", "");
  known.role = root.text("role", "");
  known.enrolled_utc = root.text("enrolled", "");
  if (document.failed()) return document.error();
  const auto parsed = parse_fingerprint(fingerprint, name + ": fingerprint");
  if (!parsed) return std::unexpected(parsed.error());
  known.fingerprint = *parsed;
  return known;
}

}  // namespace

Result<KnownAppliances> KnownAppliances::of_this_user() {
  std::filesystem::path base = home_folder();
  if (!base.empty()) base /= ".config";
  // The XDG specification: a relative path is to be ignored.
  if (const char* xdg = std::getenv("XDG_CONFIG_HOME"); xdg != nullptr && *xdg == '/') base = xdg;
  if (!base.empty()) return KnownAppliances(base / "beltpick" / "appliances");
  return failure(ResultCode::kFileNotFound,
                 "HOME: expected this user's folder, found none; set HOME or XDG_CONFIG_HOME");
}

std::filesystem::path KnownAppliances::file(const Address& address) const {
  return folder_ / (address.file_stem() + ".json");
}

Result<KnownAppliance> KnownAppliances::find(const Address& address) const {
  const std::filesystem::path path = file(address);
  const auto text = read_private_file(path);
  if (text) return parse(*text, path.string(), address);
  if (text.error().code != ResultCode::kFileNotFound) return std::unexpected(text.error());
  return failure(
      ResultCode::kNotEnrolled,
      "%s: expected an appliance that this user has enrolled with, found none of that address; run 'beltpick "
      "enrol --to %s' with its one-time token",
      address.text().c_str(), address.text().c_str());
}

Result<void> KnownAppliances::prepare() const { return prepare_private_folder(folder_); }

Result<void> KnownAppliances::keep(const KnownAppliance& appliance) const {
  contract_io::Json json{{"format", kFormat},
                         {"version", kVersion},
                         {"address", appliance.address.text()},
                         {"fingerprint", appliance.fingerprint.text()},
                         {"name", appliance.name},
                         {"role", appliance.role},
                         {"enrolled", appliance.enrolled_utc},
                         {"token", appliance.token}};
  return write_private_file(file(appliance.address), contract_io::json_text(json));
}

}  // namespace beltpick::link
