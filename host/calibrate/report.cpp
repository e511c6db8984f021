#include "calibrate/report.hpp"

#include <cmath>
#include <map>

#include "calibrate/outcome_json.hpp"
#include "calibrate/report_pictures.hpp"
#include "contract_io/file_io.hpp"
#include "html/page.hpp"

namespace beltpick::calibrate {
namespace {

using html::formatted;

std::string verdict(const Outcome& outcome) {
  const html::Tone tone = outcome.grade == Grade::kGood     ? html::Tone::kGood
                          : outcome.grade == Grade::kUsable ? html::Tone::kWarning
                                                            : html::Tone::kBad;
  std::string words;
  for (const std::string& sentence : outcome.verdict) words += (words.empty() ? "" : " ") + sentence;
  return html::note(tone, formatted("Calibration %s: ", kGradeNames[static_cast<std::size_t>(outcome.grade)]) + words);
}

std::string key_figures(const Outcome& outcome) {
  const auto row = [](const char* what, const html::Cell& value, const char* meaning) {
    return std::vector{html::text(what), value, html::text(meaning)};
  };
  return html::table(
      {"figure", "", ""},
      {row("captures used", html::text(formatted("%d of %zu", outcome.poses_used, outcome.poses.size())), ""),
       row("corners used", html::text(formatted("%d, %d left out", outcome.corners_used, outcome.corners_left_out)),
           ""),
       row("held-out captures, rms mm", html::number(outcome.held_out_rms_mm, 4),
           "corners of captures the calibration did not know"),
       row("held-out captures, largest mm", html::number(outcome.held_out_max_mm, 4), ""),
       row("held-out size of the plate, ppm", html::number(outcome.held_out_size_ppm, 0),
           "rms; 100 ppm are 0.04 mm over 400 mm"),
       row("a point's uncertainty, rms mm", html::number(outcome.point_sigma_mm, 4),
           "from the parameters, over the volume covered"),
       row("a point's uncertainty, worst mm", html::number(outcome.point_sigma_max_mm, 4), ""),
       row("camera, rms px", html::number(outcome.camera_rms_px, 4), "an axis"),
       row("projector, rms px", html::number(outcome.projector_rms_px, 4), "an axis"),
       row("between both, rms px", html::number(outcome.stereo_rms_px, 4), "across the baseline")});
}

std::string pose_table(const Outcome& outcome) {
  std::vector<std::vector<html::Cell>> rows;
  for (std::size_t p = 0; p < outcome.poses.size(); ++p) {
    const PoseOutcome& pose = outcome.poses[p];
    std::size_t used = 0;
    for (const CornerOutcome& corner : pose.corners) used += corner.used ? 1 : 0;
    const double none = std::nan("");
    rows.push_back({html::text(std::to_string(p + 1)), html::text(pose.capture),
                    html::text(pose.used ? "yes" : "no: " + pose.reason),
                    html::text(formatted("%zu of %zu", pose.used ? used : 0, pose.corners.size())),
                    html::number(pose.distance_mm, 1), html::number(pose.tilt_x_deg, 1),
                    html::number(pose.tilt_y_deg, 1), html::number(pose.camera_rms_px, 3),
                    html::number(pose.projector_rms_px, 3), html::number(pose.stereo_rms_px, 3),
                    html::number(pose.held_out ? pose.held_out_rms_mm : none, 4),
                    html::number(pose.held_out ? pose.held_out_max_mm : none, 4),
                    html::number(pose.held_out ? pose.held_out_size_ppm : none, 0)});
  }
  return html::table({"", "capture", "used", "corners", "distance mm", "up-down deg", "left-right deg", "camera px",
                      "projector px", "between px", "held out mm", "largest mm", "size ppm"},
                     rows);
}

// Captures left out, and corners of one capture and one reason together.
std::string left_out_table(const Outcome& outcome) {
  if (outcome.left_out.empty()) return "<p>Nothing was left out.</p>\n";
  std::map<std::pair<std::string, std::string>, std::string> groups;
  for (const LeftOut& one : outcome.left_out) {
    std::string& corners = groups[{one.capture, one.reason}];
    if (one.corner < 0) {
      corners = "the whole capture";
    } else {
      corners += formatted("%s%d", corners.empty() ? "corners " : ", ", one.corner);
      if (std::isfinite(one.residual_px) && one.residual_px > 0.0) corners += formatted(" (%.2f px)", one.residual_px);
    }
  }
  std::vector<std::vector<html::Cell>> rows;
  for (const auto& [group, corners] : groups) {
    rows.push_back({html::text(group.first), html::text(corners), html::text(group.second)});
  }
  return html::table({"capture", "what", "why"}, rows);
}

std::string parameter_table(const Outcome& outcome) {
  std::vector<std::vector<html::Cell>> rows;
  for (const ParameterOutcome& parameter : outcome.parameters) {
    rows.push_back({html::text(parameter.name), html::number(parameter.value, 5), html::number(parameter.sigma, 5),
                    html::text(parameter.unit)});
  }
  return html::table({"parameter", "value", "standard deviation", "unit"}, rows);
}

std::string body_of(const Outcome& outcome) {
  const Board& board = outcome.board;
  std::string body = verdict(outcome);
  body += "<p>" +
          html::escaped(formatted(
              "Calibration '%s': camera %dx%d, projector %dx%d, %s of %dx%d inner corners, %g mm squares.",
              outcome.calibration.id.c_str(), outcome.calibration.camera.width, outcome.calibration.camera.height,
              outcome.calibration.projector.width, outcome.calibration.projector.height,
              board.is_charuco() ? "ChArUco board" : "chessboard", board.columns, board.rows, board.square_mm)) +
          "</p>\n" + key_figures(outcome);
  body += "<h2>Captures held out</h2>\n" + html::figures({held_out_by_pose(outcome)});
  body += "<h2>What was covered</h2>\n" +
          html::figures({coverage_picture(outcome, Side::kCamera), coverage_picture(outcome, Side::kProjector),
                         depth_picture(outcome), tilt_picture(outcome)});
  body += "<h2>What is left over</h2>\n" +
          html::figures({residual_by_pose(outcome), residual_arrows(outcome, Side::kCamera),
                         residual_means(outcome, Side::kCamera), residual_arrows(outcome, Side::kProjector),
                         residual_means(outcome, Side::kProjector)});
  body += "<h2>The plate</h2>\n" + html::figures({plate_picture(outcome)});
  body += "<h2>Captures</h2>\n" + pose_table(outcome);
  body += "<h2>Left out</h2>\n" + left_out_table(outcome);
  return body + "<h2>Parameters</h2>\n" + parameter_table(outcome);
}

}  // namespace

Result<void> write_report(const std::filesystem::path& folder, const Outcome& outcome) {
  if (auto made = contract_io::make_folder(folder); !made) return made;
  if (auto written = contract_io::write_file(folder / "report.json", outcome_json(outcome)); !written) return written;
  return contract_io::write_file(folder / "index.html", html::page("Calibration", body_of(outcome)));
}

}  // namespace beltpick::calibrate
