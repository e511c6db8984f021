// What the self-test finds out about the store.
#pragma once

#include <filesystem>

#include "service/self_test_facts.hpp"

namespace beltpick::service {

// Looks at the store in `folder`, whoever has it, and changes nothing.
StoreFound find_store(const std::filesystem::path& folder);

}  // namespace beltpick::service
