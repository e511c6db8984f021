// What a store must hold after whatever happened to it: the versions that were acknowledged, and perhaps the one that
// was being written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "service/store.hpp"

namespace beltpick::test {

// `size` bytes that only this seed makes.
std::string seeded_bytes(std::uint32_t seed, std::size_t size);

struct ExpectedVersion {
  std::uint32_t version = 0;
  std::string bytes;
  bool removed = false;
};

struct ExpectedItem {
  service::ItemId id;
  std::vector<ExpectedVersion> acknowledged;  // oldest first, since ever
  std::optional<ExpectedVersion> in_flight;   // begun, not acknowledged: may be there or not
};

struct Comparison {
  std::string trouble;          // empty: all is as it must be
  bool in_flight_came = false;  // the one in flight is there
};

// The store must hold the newest `keep` of the acknowledged versions, with or without the one in flight, whole, and the
// newest must be current.
Comparison compare(const service::Store& store, const ExpectedItem& expected, int keep = service::Store::kKeep);

// The same for a store that is opened for it. What opening found to set aside is trouble unless `damage` is expected.
Comparison compare(const std::filesystem::path& folder, const ExpectedItem& expected, int keep = service::Store::kKeep);

}  // namespace beltpick::test
