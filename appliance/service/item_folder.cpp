#include "service/item_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "service/item_file.hpp"

namespace beltpick::service {
namespace {

constexpr std::uint32_t kLastVersion = 99'999'999;
constexpr std::size_t kDigits = 8;
constexpr std::string_view kItem = ".item";
constexpr std::string_view kPart = ".part";
constexpr std::string_view kDamaged = ".item.damaged";

std::string file_name(std::uint32_t number, std::string_view suffix) {
  std::string digits = std::to_string(number);
  digits.insert(0, kDigits - std::min(kDigits, digits.size()), '0');
  return digits.append(suffix);
}

// The number of "<8 digits><suffix>"; 0 for any other name.
std::uint32_t number_of(std::string_view name, std::string_view suffix) {
  if (name.size() != kDigits + suffix.size() || !name.ends_with(suffix)) return 0;
  std::uint32_t number = 0;
  for (const char c : name.substr(0, kDigits)) {
    if (c < '0' || c > '9') return 0;
    number = number * 10 + static_cast<std::uint32_t>(c - '0');
  }
  return number;
}

std::size_t max_file_bytes(const ItemId& id) { return item_kind(id.kind).max_bytes + kMaxItemLine; }

// Whether this is what the file is, rather than what the disk or its permissions are just now.
bool speaks_of_the_file(int error) { return error == EFBIG || error == ELOOP || error == EINVAL; }

const char* reading_failed(int error) {
  switch (error) {
    case EFBIG:
      return "it is larger than any of its kind";
    case ELOOP:
      return "it is a symbolic link";
    case EINVAL:
      return "it is no regular file";
    default:
      return std::strerror(error);
  }
}

}  // namespace

std::string ItemFolder::shown(const std::string& name) const { return contract_io::one_line((shown_ / name).string()); }

void ItemFolder::set_aside(const Folder& folder, const std::string& name, const std::string& why,
                           std::vector<std::string>& warnings) const {
  const int error = folder.rename(name, name + ".damaged");
  const std::string outcome =
      error == 0 ? "set aside as *.damaged" : std::string("left there: ") + std::strerror(error);
  warnings.push_back(why + "; it does not count any more and was " + outcome + "; upload it again where it is missed");
}

void ItemFolder::clear_away(const Folder& folder, const std::string& name, std::vector<std::string>& warnings) const {
  const int error = folder.remove(name);
  warnings.push_back(shown(name) + ": writing it was interrupted; " +
                     (error == 0 ? "cleared away" : std::string("left there: ") + std::strerror(error)) +
                     "; the version before it stays current");
}

void ItemFolder::scan_version(const Folder& folder, const std::string& name, std::uint32_t number, bool tidies,
                              std::vector<std::string>& warnings) {
  const Folder::Answer<std::string> bytes = folder.read(name, max_file_bytes(id_));
  if (!bytes && bytes.error() == ENOENT) return;  // whoever has the store deleted it just now
  last_number_ = std::max(last_number_, number);
  if (!bytes && !speaks_of_the_file(bytes.error())) {
    damaged_.push_back(number);
    warnings.push_back(shown(name) + ": cannot be read: " + reading_failed(bytes.error()) +
                       "; it does not count until it can; check the disk and the permissions");
    return;
  }
  const Result<ItemFile> item = bytes ? parse_item(*bytes, id_, number, shown(name))
                                      : failure(ResultCode::kFormatInvalid, "%s: expected a version of an item, but %s",
                                                shown(name).c_str(), reading_failed(bytes.error()));
  if (item) {
    versions_.push_back(item->info);
    return;
  }
  damaged_.push_back(number);
  if (!tidies || item.error().code == ResultCode::kVersionUnsupported) {
    warnings.emplace_back(item.error().text());
  } else {
    set_aside(folder, name, std::string(item.error().text()), warnings);
  }
}

void ItemFolder::scan(const Folder& folder, bool tidies, std::vector<std::string>& warnings) {
  const Folder::Answer<std::vector<std::string>> names = folder.names();
  if (!names) {
    warnings.push_back(shown("") + ": cannot be read: " + std::strerror(names.error()) + "; check its permissions");
    return;
  }
  for (const std::string& name : *names) {  // sorted: oldest first
    if (const std::uint32_t number = number_of(name, kItem); number > 0) {
      scan_version(folder, name, number, tidies, warnings);
    } else if (const std::uint32_t damaged = number_of(name, kDamaged); damaged > 0) {
      last_number_ = std::max(last_number_, damaged);
      damaged_.push_back(damaged);
    } else if (number_of(name, kPart) > 0) {
      if (tidies) clear_away(folder, name, warnings);  // else somebody may be writing it
    } else {
      warnings.push_back(shown(name) + ": not a file of the store; left alone");
    }
  }
  std::ranges::sort(damaged_);
}

const VersionInfo* ItemFolder::find(std::uint32_t version) const {
  const auto found = std::ranges::find(versions_, version, &VersionInfo::version);
  return found == versions_.end() ? nullptr : &*found;
}

std::optional<std::uint32_t> ItemFolder::damaged_newest() const {
  if (damaged_.empty() || (newest() != nullptr && newest()->version > damaged_.back())) return std::nullopt;
  return damaged_.back();
}

Result<Version> ItemFolder::read(const Folder& folder, std::uint32_t version) const {
  const std::string name = file_name(version, kItem);
  Folder::Answer<std::string> bytes = folder.read(name, max_file_bytes(id_));
  if (!bytes) {
    return failure(ResultCode::kFileUnreadable, "%s: expected version %u, but %s; upload it again", shown(name).c_str(),
                   version, reading_failed(bytes.error()));
  }
  Result<ItemFile> item = parse_item(*bytes, id_, version, shown(name));
  if (!item) return std::unexpected(item.error());
  bytes->erase(0, item->line_bytes);
  return Version{std::move(item->info), std::move(*bytes)};
}

Result<VersionInfo> ItemFolder::add(const Folder& folder, VersionInfo info, std::string_view bytes, int keep) {
  if (last_number_ >= kLastVersion) {
    return failure(ResultCode::kLimitExceeded, "%s: expected a version below %u, found them used up; use a new name",
                   shown("").c_str(), kLastVersion);
  }
  info.version = last_number_ + 1;
  const std::string line = item_line(id_, info);
  const std::string name = file_name(info.version, kItem);
  const int error = folder.write(name, file_name(info.version, kPart), line, bytes);
  if (error != 0) {
    const ResultCode code = contract_io::write_error_code(error);
    return failure(code, "%s: expected to write %zu bytes, found: %s; nothing was changed; %s", shown(name).c_str(),
                   line.size() + bytes.size(), std::strerror(error),
                   code == ResultCode::kDiskFull ? "free space on this disk" : "check the disk and the permissions");
  }
  last_number_ = info.version;
  versions_.push_back(info);
  prune(folder, keep);
  return info;
}

void ItemFolder::prune(const Folder& folder, int keep) {
  while (versions_.size() > static_cast<std::size_t>(keep)) {
    // One that cannot be deleted now is tried again when the store is opened.
    (void)folder.remove(file_name(versions_.front().version, kItem));
    versions_.erase(versions_.begin());
  }
  while (!damaged_.empty() && !versions_.empty() && damaged_.front() < versions_.front().version) {
    (void)folder.remove(file_name(damaged_.front(), kDamaged));
    damaged_.erase(damaged_.begin());
  }
}

}  // namespace beltpick::service
