// ItemFolder: the versions of one item in its folder: <8 digits>.item, and beside them, for a moment, <8 digits>.part
// while a version is written, and *.damaged, which was found not to be whole and counts no more.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "service/folder.hpp"
#include "service/store.hpp"

namespace beltpick::service {

class ItemFolder {
 public:
  // `shown` is the folder's path for messages.
  ItemFolder(ItemId id, std::filesystem::path shown) : id_(std::move(id)), shown_(std::move(shown)) {}

  // Reads every version and takes note of those that are whole. With `tidies` the others are set aside and leftovers of
  // a write that was interrupted cleared away. Each has a warning.
  void scan(const Folder& folder, bool tidies, std::vector<std::string>& warnings);

  // Oldest first; only whole ones.
  [[nodiscard]] const std::vector<VersionInfo>& versions() const { return versions_; }
  // The newest, also when it is a removal; null where there is none.
  [[nodiscard]] const VersionInfo* newest() const { return versions_.empty() ? nullptr : &versions_.back(); }
  [[nodiscard]] const VersionInfo* find(std::uint32_t version) const;
  // The number of a damaged version that is newer than all whole ones: what the cell should be working with.
  [[nodiscard]] std::optional<std::uint32_t> damaged_newest() const;

  // Checked again while reading. Errors: kFileUnreadable, kChecksumWrong.
  [[nodiscard]] Result<Version> read(const Folder& folder, std::uint32_t version) const;

  // The next version, with its number; then prunes. Errors: kDiskFull, kFileNotWritten, kLimitExceeded (numbers used
  // up); then nothing has changed.
  Result<VersionInfo> add(const Folder& folder, VersionInfo info, std::string_view bytes, int keep);
  // Deletes all but the newest `keep` versions, and what was set aside before those.
  void prune(const Folder& folder, int keep);

 private:
  void scan_version(const Folder& folder, const std::string& name, std::uint32_t number, bool tidies,
                    std::vector<std::string>& warnings);
  void set_aside(const Folder& folder, const std::string& name, const std::string& why,
                 std::vector<std::string>& warnings) const;
  void clear_away(const Folder& folder, const std::string& name, std::vector<std::string>& warnings) const;
  [[nodiscard]] std::string shown(const std::string& name) const;

  ItemId id_;
  std::filesystem::path shown_;
  std::vector<VersionInfo> versions_;
  std::uint32_t last_number_ = 0;       // the highest ever seen, whole or damaged: never given to other bytes
  std::vector<std::uint32_t> damaged_;  // ascending
};

}  // namespace beltpick::service
