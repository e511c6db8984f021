// What the tests of the store share: two items, and a store of a folder.
#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "service/store.hpp"
#include "support/store/expected.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::test {

inline const service::ItemId kCalibrationItem{ItemKind::kCalibration, "calibration"};
inline const service::ItemId kKnuckle{ItemKind::kTemplate, "knuckle"};

struct Opened {
  std::vector<std::string> warnings;
  Result<service::Store> store;

  explicit Opened(const std::filesystem::path& folder, int keep = service::Store::kKeep)
      : store(service::Store::open(folder, warnings, keep)) {
    if (!store) FAIL(store.error().text());
  }
  service::Store* operator->() { return &*store; }
};

inline std::filesystem::path version_file(const std::filesystem::path& folder, const service::ItemId& id,
                                          std::uint32_t version) {
  char name[32];
  std::snprintf(name, sizeof name, "%08u.item", version);
  return folder / item_kind(id.kind).name / id.name / name;
}

inline std::vector<std::uint32_t> numbers(const std::vector<service::VersionInfo>& versions) {
  std::vector<std::uint32_t> all;
  for (const service::VersionInfo& info : versions) all.push_back(info.version);
  return all;
}

}  // namespace beltpick::test
