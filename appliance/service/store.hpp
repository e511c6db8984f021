// Store: calibration, cell, templates and recipes on disk, each in its last versions.
//
// A version is one file, <folder>/<kind>/<name>/<version, 8 digits>.item, and never changes once it is there (its form:
// item_file.hpp). It is written beside its place, flushed to the disk, and renamed into it: whatever interrupts that,
// the current version, which is the highest whole one, is the old or the new one. Going back to an older version and
// removing an item are new versions themselves: nothing of the history is lost but what is older than `keep`. A number
// is never given to other bytes again. One process at a time has the folder, others may look; any thread may call.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
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
  std::string by;        // the token's name, or "start" for what the configuration named; 200 bytes of it are kept
  std::string origin;    // "upload", "import", "rollback to 3", "removed"; 200 bytes of it are kept
  bool removed = false;  // the item is out of use from this version on

  friend bool operator==(const VersionInfo&, const VersionInfo&) = default;
};

struct Version {
  VersionInfo info;
  std::string bytes;
};

class Store {
 public:
  static constexpr int kKeep = 10;
  static constexpr std::size_t kMaxItems = 1000;  // of one kind, removed ones among them

  // Opens `folder`, making it where needed. Files that are not whole are set aside (renamed to *.damaged) with a
  // warning. Error: kFileNotWritten, also while another process has it.
  static Result<Store> open(const std::filesystem::path& folder, std::vector<std::string>& warnings, int keep = kKeep);

  // What open() would find, with nothing written, made or locked: also while a beltpickd has it. A folder that is not
  // there is an empty store. put() and remove() are refused. Error: kFileUnreadable.
  static Result<Store> look(const std::filesystem::path& folder, std::vector<std::string>& warnings);

  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  // Items that have a current version, in order of kind and name.
  [[nodiscard]] std::vector<ItemId> list() const;
  // The current version; nothing where there is none or it was removed.
  [[nodiscard]] std::optional<VersionInfo> current(const ItemId& id) const;
  // Oldest first.
  [[nodiscard]] std::vector<VersionInfo> versions(const ItemId& id) const;
  // The bytes of the current version, or of another. Errors: kFileNotFound, kFileUnreadable, kChecksumWrong.
  [[nodiscard]] Result<Version> get(const ItemId& id, std::optional<std::uint32_t> version = {}) const;

  // The version that a rollback goes to which names none: the newest before the current one that has bytes; for a
  // removed item its newest, and for one whose newest was damaged the current one. A rollback is get() of it, judged,
  // and put() of its bytes. Error: kFileNotFound.
  [[nodiscard]] Result<std::uint32_t> previous(const ItemId& id) const;

  // The same bytes as the current version's make no new version, its own info comes back; but for one that is current
  // because the newest was damaged. Errors: kFileNotWritten,
  // kUsage (name), kLimitExceeded (bytes, items); then nothing has changed.
  Result<VersionInfo> put(const ItemId& id, std::string_view bytes, const std::string& by,
                          const std::string& origin = "upload");
  // A template or recipe goes out of use. Errors: kFileNotFound, kUsage (calibration and cell stay), kFileNotWritten.
  Result<VersionInfo> remove(const ItemId& id, const std::string& by);

  // Items whose newest version was damaged and set aside, with its number: an older one is current. Until put() makes a
  // new one.
  struct Fallback {
    ItemId id;
    std::uint32_t damaged = 0;
  };
  [[nodiscard]] std::vector<Fallback> fallbacks() const;

 private:
  struct State;

  explicit Store(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace beltpick::service
