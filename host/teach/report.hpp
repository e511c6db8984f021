// The teaching report: what was found on the part, in pictures and words, to look at before a robot relies on it.
#pragma once

#include <filesystem>
#include <optional>

#include "base/result.hpp"
#include "teach/rehearsal.hpp"
#include "teach/teach.hpp"

namespace beltpick::teach {

// Writes index.html and its pictures (part_0.png ...) into `folder`, which is made. `name` is the part's. Errors:
// kFileNotWritten.
Result<void> write_report(const std::filesystem::path& folder, const std::string& name, const Taught& taught,
                          const std::optional<Rehearsal>& rehearsal);

}  // namespace beltpick::teach
