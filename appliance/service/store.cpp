#include "service/store.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>

#include "base/utc.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "service/folder.hpp"
#include "service/item_folder.hpp"
#include "service/sha256.hpp"

namespace beltpick::service {
namespace {

constexpr const char* kLockFile = "lock";

// "template knuckle"; "calibration".
std::string in_words(const ItemId& id) {
  const ItemKindEntry& kind = item_kind(id.kind);
  return kind.single ? std::string(kind.name) : std::string(kind.name) + " " + contract_io::one_line(id.name);
}

bool is_valid(const ItemId& id) {
  return is_item_name(id.name) && (!item_kind(id.kind).single || id.name == item_kind(id.kind).name);
}

}  // namespace

struct Store::State {
  std::filesystem::path path;
  std::optional<Folder> root;  // nothing: a store that is looked at is not there
  Descriptor lock;             // not open: only looked at
  int keep;
  std::mutex mutex;
  std::map<ItemId, ItemFolder> items;

  [[nodiscard]] ItemFolder item_folder(const ItemId& id) const {
    return {id, path / item_kind(id.kind).name / id.name};
  }
  [[nodiscard]] const ItemFolder* find(const ItemId& id) const {
    const auto found = items.find(id);
    return found == items.end() ? nullptr : &found->second;
  }
  [[nodiscard]] Folder::Answer<Folder> open_folder(const ItemId& id) const {
    const Folder::Answer<Folder> kind = root->sub(std::string(item_kind(id.kind).name));
    return kind ? kind->sub(id.name) : std::unexpected(kind.error());
  }
  [[nodiscard]] Folder::Answer<Folder> make_folder(const ItemId& id) const;
  void scan_kind(const ItemKindEntry& kind, std::vector<std::string>& warnings);
  [[nodiscard]] Result<Version> read(const ItemId& id, std::uint32_t version) const;
  Result<VersionInfo> add(const ItemId& id, VersionInfo info, std::string_view bytes);
};

Folder::Answer<Folder> Store::State::make_folder(const ItemId& id) const {
  // With a version in it the folder itself was flushed to the disk. Without one somebody may have died before that.
  if (const ItemFolder* item = find(id); item != nullptr && item->newest() != nullptr) {
    if (Folder::Answer<Folder> known = open_folder(id)) return known;
  }
  const Folder::Answer<Folder> kind = root->make_sub(std::string(item_kind(id.kind).name));
  return kind ? kind->make_sub(id.name) : std::unexpected(kind.error());
}

void Store::State::scan_kind(const ItemKindEntry& kind, std::vector<std::string>& warnings) {
  const auto warn = [&](const std::string& name, const char* what) {
    warnings.push_back(contract_io::one_line((path / kind.name / name).string()) + ": " + what);
  };
  const Folder::Answer<Folder> folder = root->sub(std::string(kind.name));
  if (!folder && folder.error() == ENOENT) return;
  const auto names = folder ? folder->names() : std::unexpected(folder.error());
  if (!names) {
    warn("", "not a folder that can be read (links are not followed); its items do not count; move it away");
    return;
  }
  for (const std::string& name : *names) {
    const ItemId id{kind.kind, name};
    const Folder::Answer<Folder> item = folder->sub(name);
    if (!is_valid(id) || !item) {
      warn(name, "not the folder of an item; left alone");
      continue;
    }
    ItemFolder& scanned = items.emplace(id, item_folder(id)).first->second;
    scanned.scan(*item, lock.open(), warnings);
    if (lock.open()) scanned.prune(*item, keep);
  }
}

Result<Version> Store::State::read(const ItemId& id, std::uint32_t version) const {
  const Folder::Answer<Folder> folder = open_folder(id);
  if (!folder) {
    return failure(ResultCode::kFileUnreadable, "%s: expected its folder in %s, found: %s; upload it again",
                   in_words(id).c_str(), contract_io::one_line(path.string()).c_str(), std::strerror(folder.error()));
  }
  return items.at(id).read(*folder, version);
}

Result<VersionInfo> Store::State::add(const ItemId& id, VersionInfo info, std::string_view bytes) {
  if (!lock.open()) {
    return failure(ResultCode::kUsage, "%s: expected a store that was opened, found one that is only looked at",
                   in_words(id).c_str());
  }
  const Folder::Answer<Folder> folder = make_folder(id);
  if (!folder) {
    return failure(contract_io::write_error_code(folder.error()),
                   "%s: expected to make its folder in %s, found: %s; nothing was changed; check the disk",
                   in_words(id).c_str(), contract_io::one_line(path.string()).c_str(), std::strerror(folder.error()));
  }
  info.time_utc = now_utc();
  info.sha256 = sha256_hex(bytes);
  info.bytes = bytes.size();
  const auto known = items.find(id);
  if (known != items.end()) return known->second.add(*folder, std::move(info), bytes, keep);
  ItemFolder fresh = item_folder(id);
  Result<VersionInfo> added = fresh.add(*folder, std::move(info), bytes, keep);
  if (added) items.emplace(id, std::move(fresh));
  return added;
}

Store::Store(std::unique_ptr<State> state) : state_(std::move(state)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

Result<Store> Store::open(const std::filesystem::path& folder, std::vector<std::string>& warnings, int keep) {
  const std::string name = contract_io::one_line(folder.string());
  Folder::Answer<Folder> root = Folder::make(folder);
  if (!root) {
    return failure(ResultCode::kFileNotWritten, "%s: expected a folder for the store, found: %s; check the path",
                   name.c_str(), std::strerror(root.error()));
  }
  Folder::Answer<Descriptor> lock = root->lock(kLockFile);
  if (!lock) {
    const bool taken = lock.error() == EWOULDBLOCK;
    return failure(ResultCode::kFileNotWritten, "%s: expected to lock it for this process, found: %s; %s", name.c_str(),
                   taken ? "another process has it" : std::strerror(lock.error()),
                   taken ? "is a beltpickd running already? stop it first" : "check its permissions");
  }
  auto state = std::unique_ptr<State>(new State{folder, std::move(*root), std::move(*lock), std::max(keep, 1), {}, {}});
  for (const ItemKindEntry& kind : kItemKinds) state->scan_kind(kind, warnings);
  return Store(std::move(state));
}

Result<Store> Store::look(const std::filesystem::path& folder, std::vector<std::string>& warnings) {
  Folder::Answer<Folder> root = Folder::open(folder);
  if (!root && root.error() != ENOENT) {
    return failure(ResultCode::kFileUnreadable, "%s: expected a folder with a store, found: %s; check the path",
                   contract_io::one_line(folder.string()).c_str(), std::strerror(root.error()));
  }
  auto state = std::unique_ptr<State>(new State{folder, {}, {}, kKeep, {}, {}});
  if (!root) return Store(std::move(state));
  state->root = std::move(*root);
  for (const ItemKindEntry& kind : kItemKinds) state->scan_kind(kind, warnings);
  return Store(std::move(state));
}

std::vector<ItemId> Store::list() const {
  const std::scoped_lock hold(state_->mutex);
  std::vector<ItemId> ids;
  for (const auto& [id, item] : state_->items) {
    if (item.newest() != nullptr && !item.newest()->removed) ids.push_back(id);
  }
  return ids;
}

std::optional<VersionInfo> Store::current(const ItemId& id) const {
  const std::scoped_lock hold(state_->mutex);
  const ItemFolder* item = state_->find(id);
  if (item == nullptr || item->newest() == nullptr || item->newest()->removed) return std::nullopt;
  return *item->newest();
}

std::vector<VersionInfo> Store::versions(const ItemId& id) const {
  const std::scoped_lock hold(state_->mutex);
  const ItemFolder* item = state_->find(id);
  return item == nullptr ? std::vector<VersionInfo>{} : item->versions();
}

Result<Version> Store::get(const ItemId& id, std::optional<std::uint32_t> version) const {
  const std::scoped_lock hold(state_->mutex);
  const ItemFolder* item = state_->find(id);
  const VersionInfo* info = item == nullptr ? nullptr : version ? item->find(*version) : item->newest();
  if (info == nullptr) {
    const std::string which = version ? "version " + std::to_string(*version) + " of " : "";
    return failure(ResultCode::kFileNotFound, "%s%s: expected it in the store, found none; see what it lists",
                   which.c_str(), in_words(id).c_str());
  }
  if (info->removed) {
    return failure(ResultCode::kFileNotFound,
                   "%s: expected bytes, but version %u took it out of use; name an older one", in_words(id).c_str(),
                   info->version);
  }
  return state_->read(id, info->version);
}

Result<std::uint32_t> Store::previous(const ItemId& id) const {
  const std::scoped_lock hold(state_->mutex);
  if (const ItemFolder* item = state_->find(id); item != nullptr && item->newest() != nullptr) {
    const bool fell_back = item->damaged_newest().has_value();
    for (auto info = item->versions().rbegin(); info != item->versions().rend(); ++info) {
      if (!info->removed && (fell_back || info->version != item->newest()->version)) return info->version;
    }
  }
  return failure(ResultCode::kFileNotFound, "%s: expected an older version to go back to, found none",
                 in_words(id).c_str());
}

Result<VersionInfo> Store::put(const ItemId& id, std::string_view bytes, const std::string& by,
                               const std::string& origin) {
  const ItemKindEntry& kind = item_kind(id.kind);
  if (!is_valid(id)) {
    return failure(ResultCode::kUsage, "%s: expected %s as its name, found \"%s\"", std::string(kind.name).c_str(),
                   kind.single ? std::string(kind.name).c_str() : "up to 64 letters, digits, '.', '_' and '-'",
                   contract_io::one_line(id.name).substr(0, kMaxItemName).c_str());
  }
  if (bytes.size() > kind.max_bytes) {
    return failure(ResultCode::kLimitExceeded, "%s: expected at most %zu bytes, found %zu", in_words(id).c_str(),
                   kind.max_bytes, bytes.size());
  }
  const std::scoped_lock hold(state_->mutex);
  const ItemFolder* item = state_->find(id);
  const VersionInfo* newest = item == nullptr ? nullptr : item->newest();
  if (newest != nullptr && !newest->removed && !item->damaged_newest()) {
    // Compared with what the disk holds: a version that was damaged meanwhile is no reason not to write.
    const Result<Version> there = state_->read(id, newest->version);
    if (there && there->bytes == bytes) return *newest;
  }
  const auto of_kind = [&](const auto& entry) { return entry.first.kind == id.kind; };
  if (item == nullptr && std::cmp_greater_equal(std::ranges::count_if(state_->items, of_kind), kMaxItems)) {
    return failure(ResultCode::kLimitExceeded, "%s: expected at most %zu of this kind, found as many; reuse a name",
                   in_words(id).c_str(), kMaxItems);
  }
  VersionInfo info;
  info.by = by;
  info.origin = origin;
  return state_->add(id, std::move(info), bytes);
}

Result<VersionInfo> Store::remove(const ItemId& id, const std::string& by) {
  if (item_kind(id.kind).single) {
    return failure(ResultCode::kUsage,
                   "%s: expected a template or recipe; a cell cannot do without this: upload another",
                   in_words(id).c_str());
  }
  const std::scoped_lock hold(state_->mutex);
  const ItemFolder* item = state_->find(id);
  if (item == nullptr || item->newest() == nullptr || item->newest()->removed) {
    return failure(ResultCode::kFileNotFound, "%s: expected it in the store, found none of that name",
                   in_words(id).c_str());
  }
  VersionInfo info;
  info.by = by;
  info.origin = "removed";
  info.removed = true;
  return state_->add(id, std::move(info), {});
}

std::vector<Store::Fallback> Store::fallbacks() const {
  const std::scoped_lock hold(state_->mutex);
  std::vector<Fallback> found;
  for (const auto& [id, item] : state_->items) {
    if (const std::optional<std::uint32_t> damaged = item.damaged_newest()) found.push_back({id, *damaged});
  }
  return found;
}

}  // namespace beltpick::service
