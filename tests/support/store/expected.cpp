#include "support/store/expected.hpp"

#include <algorithm>
#include <random>

namespace beltpick::test {
namespace {

std::string numbers_of(const auto& versions) {
  std::string text;
  for (const auto& version : versions) text += std::to_string(version.version) + " ";
  return text;
}

// Whether version and bytes are what they must be; else what is wrong.
std::string compare_version(const service::Store& store, const service::ItemId& id, const ExpectedVersion& expected) {
  const std::string name = "version " + std::to_string(expected.version) + ": ";
  const Result<service::Version> got = store.get(id, expected.version);
  if (expected.removed) return got ? name + "expected a removal, found bytes" : "";
  if (!got) return name + std::string(got.error().text());
  if (got->bytes != expected.bytes) return name + "other bytes";
  return "";
}

}  // namespace

std::string seeded_bytes(std::uint32_t seed, std::size_t size) {
  std::mt19937 random(seed);
  std::string bytes(size, '\0');
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4) {
    const auto word = static_cast<std::uint32_t>(random());
    for (std::size_t b = 0; b < 4; ++b) bytes[i + b] = static_cast<char>(word >> (8 * b) & 0xffU);
  }
  for (; i < size; ++i) bytes[i] = static_cast<char>(random() & 0xffU);
  return bytes;
}

Comparison compare(const service::Store& store, const ExpectedItem& expected, int keep) {
  Comparison result;
  std::vector<ExpectedVersion> wanted = expected.acknowledged;
  const std::vector<service::VersionInfo> found = store.versions(expected.id);
  if (expected.in_flight && !found.empty() && found.back().version == expected.in_flight->version) {
    wanted.push_back(*expected.in_flight);
    result.in_flight_came = true;
  }
  const std::size_t kept = std::min(wanted.size(), static_cast<std::size_t>(keep));
  wanted.erase(wanted.begin(), wanted.end() - static_cast<std::ptrdiff_t>(kept));
  if (numbers_of(found) != numbers_of(wanted)) {
    result.trouble = "expected versions " + numbers_of(wanted) + "found " + numbers_of(found);
    return result;
  }
  for (const ExpectedVersion& version : wanted) {
    result.trouble = compare_version(store, expected.id, version);
    if (!result.trouble.empty()) return result;
  }
  const std::optional<service::VersionInfo> current = store.current(expected.id);
  const bool in_use = !wanted.empty() && !wanted.back().removed;
  if (current.has_value() != in_use || (in_use && current->version != wanted.back().version)) {
    result.trouble = "the current version is not the newest";
  }
  return result;
}

Comparison compare(const std::filesystem::path& folder, const ExpectedItem& expected, int keep) {
  std::vector<std::string> warnings;
  const Result<service::Store> store = service::Store::open(folder, warnings, keep);
  if (!store) return {std::string(store.error().text()), false};
  for (const std::string& warning : warnings) {
    if (warning.find(".part: ") == std::string::npos) return {warning, false};
  }
  return compare(*store, expected, keep);
}

}  // namespace beltpick::test
