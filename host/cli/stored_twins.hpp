// `beltpick upload template`: whether the appliance keeps parts that the new one is taken for.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "link/appliance.hpp"
#include "session.hpp"
#include "upload_item.hpp"

namespace beltpick::cli {

// One line for each template on the appliance, but earlier versions of this one, that the uploaded one is too much like
// to be told from it on every side. About a second for each that is a stranger, 10 for others. A template there that
// cannot be fetched or read has a line that says so. Errors: those of the list of items, of reading the template.
Result<std::vector<std::string>> stored_twins(link::Appliance& appliance, const UploadItem& item,
                                              const Session& session);

}  // namespace beltpick::cli
