#include "service/store_facts.hpp"

#include <ctime>

#include "service/store.hpp"

namespace beltpick::service {
namespace {

// Days since a time as VersionInfo has it; nothing where it is none.
std::optional<double> days_since(const std::string& time_utc) {
  std::tm broken{};
  if (strptime(time_utc.c_str(), "%Y-%m-%dT%H:%M:%SZ", &broken) == nullptr) return std::nullopt;
  return std::difftime(std::time(nullptr), timegm(&broken)) / 86400.0;
}

std::string in_words(const Store& store, const Store::Fallback& fallback) {
  const auto current = store.current(fallback.id);
  return std::string(item_kind(fallback.id.kind).name) + " " + fallback.id.name + ": version " +
         std::to_string(fallback.damaged) + " is damaged, " +
         (current ? "version " + std::to_string(current->version) + " is used" : "no other is there");
}

}  // namespace

StoreFound find_store(const std::filesystem::path& folder) {
  StoreFound found;
  found.configured = true;
  std::vector<std::string> warnings;
  const Result<Store> store = Store::look(folder, warnings);
  if (!store) {
    found.problem = store.error();
    return found;
  }
  found.items = static_cast<int>(store->list().size());
  if (const auto fallbacks = store->fallbacks(); !fallbacks.empty())
    found.damaged = in_words(*store, fallbacks.front());
  if (const auto calibration = store->current({ItemKind::kCalibration, "calibration"})) {
    found.calibration_age_days = days_since(calibration->time_utc);
  }
  return found;
}

}  // namespace beltpick::service
