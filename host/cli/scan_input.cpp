#include "scan_input.hpp"

#include <filesystem>

#include "contract/result_codes.hpp"
#include "progress.hpp"
#include "segmented_input.hpp"

namespace beltpick::cli {
namespace {

// What is wrong with a part that is cut out, but no reason to refuse it.
void warn_of(const scans::CutOut& part, const segment::Segmented& objects, const std::string& path,
             const Session& session) {
  if (part.left_aside > 0) {
    session.warn({path + ": " + std::to_string(part.left_aside) +
                  " small objects beside the part were left aside; the largest object counts as the part"});
  }
  if (!objects.belt) {
    session.warn({path + ": no belt or table carries the view, so all that was measured counts as the part"});
  }
}

Result<scans::ScanView> read_scan(const std::string& path, const std::string& calibration, const Session& session) {
  // A part's own concave edges are no reason to cut it apart.
  const auto input = SegmentedInput::make({path, calibration, true}, session);
  if (!input) return std::unexpected(input.error());
  const segment::Segmented& objects = (*input)->objects();
  const auto part = scans::cut_out_part((*input)->input().range(), objects, path);
  if (!part) return std::unexpected(part.error());
  warn_of(*part, objects, path, session);
  return scans::make_view({path, (*input)->input().range(), (*input)->input().lens(), objects.labels, objects.belt},
                          *part);
}

Result<std::vector<scans::ScanView>> read_scans(const std::vector<std::string>& paths, const std::string& calibration,
                                                const Session& session) {
  Progress progress("scans", static_cast<int>(paths.size()), session.json);
  std::vector<scans::ScanView> views;
  for (const std::string& path : paths) {
    auto view = read_scan(path, calibration, session);
    if (!view) return std::unexpected(view.error());
    views.push_back(std::move(*view));
    progress.show(static_cast<int>(views.size()));
  }
  return views;
}

}  // namespace

bool are_scans(const std::vector<std::string>& paths) {
  if (paths.size() != 1) return true;
  const std::filesystem::path path(paths.front());
  return path.extension() == ".npy" || path.extension() == ".zip" || std::filesystem::is_directory(path);
}

Result<scans::Stitched> stitch_scans(const std::vector<std::string>& paths, const std::string& calibration,
                                     const Session& session) {
  const auto views = read_scans(paths, calibration, session);
  if (!views) return std::unexpected(views.error());
  Progress progress("register", static_cast<int>(views->size() * (views->size() - 1) / 2), session.json);
  return scans::stitch(*views, [&](int done, int) { progress.show(done); });
}

contract_io::Json scans_json(const scans::Stitched& stitched) {
  using contract_io::Json;
  Json scans = Json::array();
  for (const scans::ScanReport& scan : stitched.scans) {
    const Mat4 pose = scan.T_part_scan.matrix();
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) rows.push_back({pose(r, 0), pose(r, 1), pose(r, 2), pose(r, 3)});
    scans.push_back({{"scan", scan.name},
                     {"points", scan.points},
                     {"noise_mm", scan.noise_mm},
                     {"residual_mm", scan.residual_mm},
                     {"shared", scan.shared},
                     {"alone", scan.alone},
                     {"part_from_camera", rows}});
  }
  Json missing = Json::array();
  for (const scans::Side& side : stitched.missing)
    missing.push_back({{"side", side.name}, {"missing_share", side.missing_share}});
  return {{"scans", scans},
          {"residual_mm", stitched.residual_mm},
          {"dropped_points", stitched.dropped},
          {"missing", missing}};
}

std::string scans_text(const scans::Stitched& stitched) {
  char line[300];
  std::snprintf(line, sizeof line, "%zu scans, %.3f mm rms off each other where they overlap\n", stitched.scans.size(),
                stitched.residual_mm);
  std::string text = line;
  for (const scans::ScanReport& scan : stitched.scans) {
    std::snprintf(line, sizeof line, "  %s: %zu points, %.3f mm off the others, shares %.0f %%, %.0f %% only here\n",
                  scan.name.c_str(), scan.points, scan.residual_mm, 100 * scan.shared, 100 * scan.alone);
    text += line;
  }
  return text;
}

}  // namespace beltpick::cli
