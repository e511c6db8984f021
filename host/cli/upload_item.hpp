// What `beltpick upload` sends for a file: judged before it leaves, and whole in itself where the file names others.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "contract/api.hpp"
#include "link/appliance.hpp"

namespace beltpick::cli {

struct UploadItem {
  std::string file;
  link::RouteValues id;
  std::string bytes;
};

// Reads and judges `file` as the appliance will. A recipe's sequence file is put inline, and its templates become the
// names that the appliance knows them by. `name` is the item's, or empty for the file's stem. Errors: kUsage for a name
// that cannot be one; those of the format's reader.
Result<UploadItem> prepare_upload(ItemKind kind, const std::filesystem::path& file, const std::string& name);

}  // namespace beltpick::cli
