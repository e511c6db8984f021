// The scans of one part, as `beltpick teach` takes them: captures, organised clouds and point clouds, the part cut out
// of each.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract_io/json_writer.hpp"
#include "scans/stitch.hpp"
#include "session.hpp"

namespace beltpick::cli {

// Whether the files are scans rather than one mesh: several of them, or one capture (.zip, folder) or cloud (.npy).
bool are_scans(const std::vector<std::string>& paths);

// Reads the scans, cuts the part out of each (what was left aside is warned of) and stitches them. Errors: as
// RangeInput, cut_out_part, make_view and stitch; messages name the file.
Result<scans::Stitched> stitch_scans(const std::vector<std::string>& paths, const std::string& calibration,
                                     const Session& session);

// How the scans fit, for the command's answer.
contract_io::Json scans_json(const scans::Stitched& stitched);
std::string scans_text(const scans::Stitched& stitched);

}  // namespace beltpick::cli
