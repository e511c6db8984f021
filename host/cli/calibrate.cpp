// beltpick calibrate: captures of a plate to the geometry of camera and projector.
#include "calibrate/calibrate.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "board_options.hpp"
#include "calibrate/observations_io.hpp"
#include "calibrate/outcome_json.hpp"
#include "calibrate/report.hpp"
#include "calibrate_actions.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/file_io.hpp"
#include "options.hpp"
#include "plate_capture.hpp"
#include "progress.hpp"
#include "text_table.hpp"

namespace beltpick::cli {
namespace {

namespace fs = std::filesystem;
using calibrate::Observations;
using calibrate::Outcome;
using contract_io::Json;

struct CalibrateOptions {
  std::vector<std::string> captures, leave_out;
  std::string out, report, resume, id, camera_serial, projector_serial;
  BoardOptions board;
};

Result<void> check_usage(const CalibrateOptions& options) {
  const bool resumed = !options.resume.empty();
  if (options.captures.empty() && !resumed) {
    return failure(ResultCode::kUsage, "expected CAPTURE... of the plate, or --resume, found neither");
  }
  if (options.out.empty()) return failure(ResultCode::kUsage, "expected --out calibration.json, found none");
  if (resumed && !options.board.size.empty()) {
    return failure(ResultCode::kUsage, "--board: does not go with --resume, whose file tells the plate");
  }
  return {};
}

// The captures that `path` means: itself, or those in the folder.
std::vector<fs::path> captures_at(const fs::path& path) {
  std::error_code none;
  if (!fs::is_directory(path, none) || fs::exists(path / "capture.json", none)) return {path};
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(path, none)) {
    const bool folder = fs::exists(entry.path() / "capture.json", none);
    if (folder || entry.path().extension() == ".zip") found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found.empty() ? std::vector{path} : found;
}

bool shows_the_same(const calibrate::ObservedPose& a, const calibrate::ObservedPose& b) {
  return std::equal(a.corners.begin(), a.corners.end(), b.corners.begin(), b.corners.end(),
                    [](const auto& one, const auto& other) {
                      return one.corner == other.corner && one.camera_px.column_px == other.camera_px.column_px &&
                             one.camera_px.row_px == other.camera_px.row_px;
                    });
}

// `detail` without the capture's name before it.
std::string without_name(std::string_view detail, const std::string& name) {
  if (detail.starts_with(name + ": ")) detail.remove_prefix(name.size() + 2);
  return std::string(detail);
}

// Adds what a capture shows. A capture of another camera or projector than the first is an error.
Result<void> add_pose(const fs::path& path, const PlateCapture& plate, Observations& seen) {
  const bool first = seen.camera_width == 0;
  if (first) {
    seen.camera_width = plate.camera_width;
    seen.camera_height = plate.camera_height;
    seen.projector = plate.projector;
  }
  const auto same = [&](const ProjectorGrid& grid) {
    return grid.width == seen.projector.width && grid.height == seen.projector.height &&
           grid.layout == seen.projector.layout;
  };
  if (plate.camera_width != seen.camera_width || plate.camera_height != seen.camera_height || !same(plate.projector)) {
    return failure(ResultCode::kFrameSizeMismatch,
                   "%s: expected a camera of %dx%d and a projector of %dx%d as in the captures before, found %dx%d and "
                   "%dx%d; give captures of one rig",
                   contract_io::one_line(path.string()).c_str(), seen.camera_width, seen.camera_height,
                   seen.projector.width, seen.projector.height, plate.camera_width, plate.camera_height,
                   plate.projector.width, plate.projector.height);
  }
  calibrate::ObservedPose pose = plate.pose;
  for (const auto& known : seen.poses) {
    if (known.capture != pose.capture) continue;
    if (shows_the_same(known, pose)) {
      seen.left_out.push_back({contract_io::one_line(path.string()), -1, "the same capture is there already"});
      return {};
    }
    pose.capture = contract_io::one_line(path.string());  // another folder of the same name
  }
  seen.poses.push_back(std::move(pose));
  return {};
}

// A capture without a plate, or one that cannot be decoded for what its images show, is left out and named; all else
// that is wrong with a capture ends the command.
bool costs_one_pose(ResultCode code) {
  constexpr std::array kOfImages{
      ResultCode::kNothingFound, ResultCode::kFrameBlack,         ResultCode::kFrameDuplicated,
      ResultCode::kFrameMissing, ResultCode::kSequenceOrderWrong, ResultCode::kBeltMovedDuringCapture,
      ResultCode::kFocusOff};
  return std::find(kOfImages.begin(), kOfImages.end(), code) != kOfImages.end();
}

Result<void> read_captures(const CalibrateOptions& options, Observations& seen, Session& session) {
  std::vector<fs::path> paths;
  for (const std::string& path : options.captures) {
    const auto found = captures_at(path);
    paths.insert(paths.end(), found.begin(), found.end());
  }
  Progress progress("captures", static_cast<int>(paths.size()), session.json);
  contract_io::Warnings warnings;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto plate = read_plate(paths[i], seen.board, warnings, true);
    if (plate) {
      if (auto added = add_pose(paths[i], *plate, seen); !added) return added;
    } else if (costs_one_pose(plate.error().code)) {
      const std::string name = contract_io::one_line(paths[i].string());
      seen.left_out.push_back({name, -1, without_name(plate.error().text(), name)});
    } else {
      return std::unexpected(plate.error());
    }
    progress.show(static_cast<int>(i) + 1);
  }
  session.warn(warnings);
  return {};
}

// Takes the captures named by --leave-out out of what was seen.
Result<void> leave_out_named(const std::vector<std::string>& names, Observations& seen) {
  for (const std::string& name : names) {
    const auto found =
        std::find_if(seen.poses.begin(), seen.poses.end(), [&](const auto& pose) { return pose.capture == name; });
    if (found == seen.poses.end()) {
      return failure(ResultCode::kUsage,
                     "--leave-out: expected the name of a capture that shows the plate, such as '%s', "
                     "found '%s'",
                     seen.poses.empty() ? "000" : seen.poses.front().capture.c_str(),
                     contract_io::one_line(name).substr(0, 60).c_str());
    }
    seen.left_out.push_back({name, -1, "left out as asked for"});
    seen.poses.erase(found);
  }
  return {};
}

Result<Observations> gather(const CalibrateOptions& options, Session& session) {
  Observations seen;
  if (!options.resume.empty()) {
    contract_io::Warnings warnings;
    auto read = calibrate::read_observations(options.resume, warnings);
    session.warn(warnings);
    if (!read) return read;
    seen = std::move(*read);
  } else {
    const auto board = board_of(options.board);
    if (!board) return std::unexpected(board.error());
    seen.board = *board;
  }
  if (auto read = read_captures(options, seen, session); !read) return std::unexpected(read.error());
  if (auto left = leave_out_named(options.leave_out, seen); !left) return std::unexpected(left.error());
  return seen;
}

// The same for the same figures, another for others (FNV-1a), so that a cell file is tied to its calibration.
std::string identity_of(const Outcome& outcome) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const auto& parameter : outcome.parameters) {
    const auto bits = std::bit_cast<std::uint64_t>(parameter.value);
    for (unsigned shift = 0; shift < 64; shift += 8) hash = (hash ^ ((bits >> shift) & 0xffU)) * 1099511628211ULL;
  }
  char text[32];
  std::snprintf(text, sizeof text, "calibration-%08x", static_cast<unsigned>(hash >> 32U));
  return text;
}

fs::path observations_beside(const fs::path& out) { return fs::path(out).replace_extension(".observations.json"); }

Result<void> write_all(const CalibrateOptions& options, const Observations& seen, const Outcome& outcome) {
  if (auto written = contract_io::write_calibration(options.out, outcome.calibration, calibrate::quality_json(outcome));
      !written) {
    return written;
  }
  if (auto written = calibrate::write_observations(observations_beside(options.out), seen); !written) return written;
  return options.report.empty() ? Result<void>{} : calibrate::write_report(options.report, outcome);
}

std::string number(const char* format, double value) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// A line a capture; of its corners the first few with their reasons.
std::string describe_left_out(const Outcome& outcome) {
  constexpr int kNamed = 4;
  std::string text = outcome.left_out.empty() ? "" : "\nleft out:\n";
  std::map<std::string, int> corners;
  for (const auto& item : outcome.left_out) {
    if (item.corner >= 0 && ++corners[item.capture] > kNamed) continue;
    const std::string where = item.corner < 0 ? "" : " corner " + std::to_string(item.corner);
    text += "  " + item.capture + where + ": " + item.reason + "\n";
  }
  for (const auto& [capture, count] : corners) {
    if (count > kNamed)
      text += "  " + capture + ": " + std::to_string(count - kNamed) + " corners more; --json names them\n";
  }
  return text;
}

std::string describe(const CalibrateOptions& options, const Outcome& outcome) {
  std::string text = options.out + ": " + outcome.calibration.id + "\n";
  for (const std::string& sentence : outcome.verdict) text += sentence + "\n";
  std::vector<std::vector<std::string>> rows{{"capture", "camera px", "projector px", "stereo px", "held out mm", ""}};
  for (const auto& pose : outcome.poses) {
    if (!pose.used) continue;
    rows.push_back({pose.capture, number("%.3f", pose.camera_rms_px), number("%.3f", pose.projector_rms_px),
                    number("%.3f", pose.stereo_rms_px), number("%.3f", pose.held_out_rms_mm), ""});
  }
  rows.push_back({"all", number("%.3f", outcome.camera_rms_px), number("%.3f", outcome.projector_rms_px),
                  number("%.3f", outcome.stereo_rms_px), number("%.3f", outcome.held_out_rms_mm), ""});
  text += "\n" + text_table(rows);
  return text + describe_left_out(outcome);
}

Result<void> run(const CalibrateOptions& options, Session& session) {
  if (auto checked = check_usage(options); !checked) return checked;
  const auto seen = gather(options, session);
  if (!seen) return std::unexpected(seen.error());
  std::unique_ptr<Progress> progress;
  auto outcome = calibrate::calibrate(*seen, [&](int done, int total) {
    if (!progress) progress = std::make_unique<Progress>("holding poses out", total, session.json);
    progress->show(done);
  });
  progress.reset();
  if (!outcome) return std::unexpected(outcome.error());
  outcome->calibration.id = options.id.empty() ? identity_of(*outcome) : options.id;
  outcome->calibration.camera_serial = options.camera_serial;
  outcome->calibration.projector_serial = options.projector_serial;
  if (auto written = write_all(options, *seen, *outcome); !written) return written;
  session.answer(Json::parse(calibrate::outcome_json(*outcome)), describe(options, *outcome));
  return {};
}

}  // namespace

Run add_calibrate(CLI::App& app) {
  const auto actions = std::make_shared<CalibrateActions>(app);
  const auto options = std::make_shared<CalibrateOptions>();
  app.add_option("CAPTURE", options->captures,
                 "8 to 30 captures of the plate in all sorts of poses, both axes coded: folders, .zip, or a folder of "
                 "such");
  add_board_options(app, options->board);
  app.add_option("--out", options->out, "the result; the corners are kept beside it for --resume")
      ->type_name("calibration.json");
  app.add_option("--report", options->report, "write index.html with pictures and figures, and report.json")
      ->type_name("DIR");
  app.add_option("--resume", options->resume, "calibrate again from kept corners, with further captures if any")
      ->type_name("calibration.observations.json");
  app.add_option("--leave-out", options->leave_out, "a capture not to use, by its name in the report; repeat for more")
      ->type_name("NAME")
      ->expected(1)
      ->take_all();
  app.add_option("--id", options->id, "of the calibration (default: made from its figures)");
  app.add_option("--camera-serial", options->camera_serial, "of the camera that the appliance then expects");
  app.add_option("--projector-serial", options->projector_serial, "of the projector likewise");
  example(app,
          "  beltpick calibrate plates/* --board 11x8 --square-mm 20 --out calibration.json --report report\n"
          "  beltpick calibrate --resume calibration.observations.json plates/new --out calibration.json\n"
          "  beltpick calibrate --resume calibration.observations.json --leave-out 007 --out calibration.json\n"
          "  beltpick calibrate diff old.json new.json --cell cell.json");
  return [actions, options](Session& session) {
    return actions->chosen() ? actions->run(session) : run(*options, session);
  };
}

}  // namespace beltpick::cli
