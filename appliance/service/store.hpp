// Store: calibration, cell, templates and recipes on disk, each in its last versions.
//
// A version is one file, <folder>/<kind>/<name>/<version, 8 digits>.item, and never changes once it is there: a line
//   beltpick-item 1 {"sha256": ..., "bytes": ..., "time": ..., "by": ..., "origin": ...}
// and the item's bytes. It is written beside its place, flushed to the disk, and renamed into it: whatever interrupts
// that, the current version, which is the highest whole one, is the old or the new one. Going back to an older version
// and removing an item are new versions themselves: nothing of the history is lost but what is older than `keep`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "contract/api.hpp"

namespace beltpick::service {

struct ItemId {
  ItemKind kind = ItemKind::kCalibration;
  std::string name;  // that of the kind for calibration and cell

  friend auto operator<=>(const ItemId&, const ItemId&) = default;
};

struct VersionInfo {
  std::uint32_t version = 0;  // from 1
  std::string sha256;         // of the bytes, in hex
  std::size_t bytes = 0;
  std::string time_utc;  // ISO 8601
  std::string by;        // the token's name, or "start" for what the configuration named
  std::string origin;    // "upload", "import", "rollback to 3", "removed"
  bool removed = false;  // the item is out of use from this version on
};

struct Version {
  VersionInfo info;
  std::string bytes;
};

class Store {
 public:
  static constexpr int kKeep = 10;

  // Opens `folder`, making it where needed. Files that are not whole are set aside (renamed to *.damaged) with a
  // warning. Errors: kFileNotWritten, kFileUnreadable.
  static Result<Store> open(const std::filesystem::path& folder, std::vector<std::string>& warnings, int keep = kKeep);

  // Items that have a current version, in order of kind and name.
  [[nodiscard]] std::vector<ItemId> list() const;
  // The current version; nothing where there is none or it was removed.
  [[nodiscard]] std::optional<VersionInfo> current(const ItemId& id) const;
  // Oldest first.
  [[nodiscard]] std::vector<VersionInfo> versions(const ItemId& id) const;
  // The bytes of the current version, or of another. Errors: kFileNotFound, kFileUnreadable, kChecksumWrong.
  [[nodiscard]] Result<Version> get(const ItemId& id, std::optional<std::uint32_t> version = {}) const;

  // The same bytes as the current version's make no new version: its own info comes back. Error: kFileNotWritten; then
  // nothing has changed.
  Result<VersionInfo> put(const ItemId& id, std::string_view bytes, const std::string& by,
                          const std::string& origin = "upload");
  // A template or recipe goes out of use. Errors: kFileNotFound, kUsage (calibration and cell stay), kFileNotWritten.
  Result<VersionInfo> remove(const ItemId& id, const std::string& by);
};

}  // namespace beltpick::service
