// The first filling of the store: the files that the configuration names become version 1 of the items that the store
// never had.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/settings.hpp"
#include "service/store.hpp"

namespace beltpick::app {

using ImportedItems = std::vector<std::pair<service::ItemId, std::string>>;

// What of `[model]` the store lacks, by name of the file. A file that is not there is left out; one that cannot be read
// is left out with a warning.
ImportedItems items_to_import(const Settings& settings, const service::Store& store,
                              std::vector<std::string>& warnings);

}  // namespace beltpick::app
