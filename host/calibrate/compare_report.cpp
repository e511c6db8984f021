#include "calibrate/compare_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"
#include "contract_io/file_io.hpp"
#include "html/page.hpp"
#include "html/plot.hpp"

namespace beltpick::calibrate {
namespace {

using html::formatted;

void add_lens(std::vector<ParameterPair>& rows, const std::string& which, const Lens& a, const Lens& b) {
  rows.push_back({which + " fx px", a.fx_px, b.fx_px});
  rows.push_back({which + " fy px", a.fy_px, b.fy_px});
  rows.push_back({which + " cx px", a.cx_px, b.cx_px});
  rows.push_back({which + " cy px", a.cy_px, b.cy_px});
  constexpr std::array kNames{"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    rows.push_back({which + " " + kNames[i], a.distortion[i], b.distortion[i]});
  }
}

double axes_deg(const Calibration& calibration) {
  return deg_from_rad(std::acos(std::clamp(calibration.T_projector_camera.rotation(2, 2), -1.0, 1.0)));
}

Vec3 belt_middle_mm(const Comparison& comparison) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const ComparedPoint& point : comparison.points) {
    if (point.layer != 0) continue;
    sum += point.new_mm;
    ++count;
  }
  return count > 0 ? Vec3(sum / count) : sum;
}

// One coordinate of new - old at the belt as a map over the camera's image, after `motion`.
html::Figure map_of(const Comparison& comparison, const RigidFit& motion, int coordinate, const std::string& title) {
  const auto off_mm = [&](const ComparedPoint& point) { return (motion * point.new_mm - point.old_mm)[coordinate]; };
  double largest_mm = 1e-9;
  for (const ComparedPoint& point : comparison.points) {
    if (point.layer == 0) largest_mm = std::max(largest_mm, std::abs(off_mm(point)));
  }
  html::Plot plot(title, {"camera column px", {0.0, comparison.image_width - 1.0}},
                  {"camera row px", {comparison.image_height - 1.0, 0.0}}, true, 360);
  const double half_column_px = comparison.grid_step_px.column_px / 2, half_row_px = comparison.grid_step_px.row_px / 2;
  for (const ComparedPoint& point : comparison.points) {
    if (point.layer != 0) continue;
    const auto& [column, row] = point.camera_px;
    plot.cell({std::max(0.0, column - half_column_px), std::max(0.0, row - half_row_px)},
              {std::min(comparison.image_width - 1.0, column + half_column_px),
               std::min(comparison.image_height - 1.0, row + half_row_px)},
              html::diverging_colour(off_mm(point) / largest_mm), formatted("%.4f mm", off_mm(point)));
  }
  plot.scale("mm", {-largest_mm, largest_mm}, true);
  return {plot.svg(), formatted("largest %.4f mm", largest_mm)};
}

std::string maps(const Comparison& comparison, const RigidFit& motion) {
  return html::figures({map_of(comparison, motion, 2, "depth (camera z), new - old"),
                        map_of(comparison, motion, 0, "across (camera x), new - old"),
                        map_of(comparison, motion, 1, "along (camera y), new - old")});
}

std::string spreads(const Comparison& comparison) {
  const auto row = [](const char* what, const Spread& spread) {
    return std::vector{html::text(what), html::number(spread.rms_mm, 4), html::number(spread.max_mm, 4)};
  };
  return html::table({"", "rms mm", "largest mm"},
                     {row("as they stand, at the belt", comparison.belt),
                      row("as they stand, in the volume above it", comparison.volume),
                      row("after the best rigid motion, at the belt", comparison.belt_moved),
                      row("after the best rigid motion, in the volume", comparison.volume_moved)});
}

std::string parameter_table(const std::vector<ParameterPair>& parameters) {
  std::vector<std::vector<html::Cell>> rows;
  for (const ParameterPair& row : parameters) {
    rows.push_back({html::text(row.name), html::number(row.old_value, 5), html::number(row.new_value, 5),
                    html::number(row.new_value - row.old_value, 5)});
  }
  return html::table({"parameter", "old", "new", "change"}, rows);
}

}  // namespace

std::vector<ParameterPair> parameters_of(const Calibration& old_calibration, const Calibration& new_calibration) {
  std::vector<ParameterPair> rows;
  add_lens(rows, "camera", old_calibration.camera, new_calibration.camera);
  add_lens(rows, "projector", old_calibration.projector, new_calibration.projector);
  const Vec3& old_mm = old_calibration.T_projector_camera.translation_mm;
  const Vec3& new_mm = new_calibration.T_projector_camera.translation_mm;
  rows.push_back({"baseline mm", old_mm.norm(), new_mm.norm()});
  rows.push_back({"angle between the axes deg", axes_deg(old_calibration), axes_deg(new_calibration)});
  return rows;
}

double motion_deg(const Comparison& comparison) {
  return deg_from_rad(rotation_between_rad(Mat3::Identity(), comparison.motion.rotation));
}

double motion_mm(const Comparison& comparison) {
  const Vec3 middle_mm = belt_middle_mm(comparison);
  return (comparison.motion * middle_mm - middle_mm).norm();
}

std::string verdict(const Comparison& comparison) {
  std::string words =
      formatted("The same measurement differs by up to %.3f mm at the belt (%.3f mm rms), by up to %.3f mm ",
                comparison.belt.max_mm, comparison.belt.rms_mm, comparison.volume.max_mm);
  words += formatted("in the %.0f mm above it. After the best rigid motion (%.4f degrees, ", comparison.height_mm,
                     motion_deg(comparison));
  words += formatted(
      "%.3f mm), which a new belt frame and hand-eye calibration would take up, up to %.3f mm and %.3f mm "
      "are left.",
      motion_mm(comparison), comparison.belt_moved.max_mm, comparison.volume_moved.max_mm);
  return words;
}

Result<void> write_compare_report(const std::filesystem::path& folder, const ComparedFiles& files,
                                  const Comparison& comparison, const std::vector<ParameterPair>& parameters) {
  if (auto made = contract_io::make_folder(folder); !made) return made;
  std::string body = "<p>" + html::escaped(verdict(comparison)) + "</p>\n<p>Old: " + html::escaped(files.old_name) +
                     "; new: " + html::escaped(files.new_name) + ". Belt ";
  body += formatted("%.1f mm from the camera", comparison.distance_mm);
  body += comparison.distance_guessed ? ", guessed from where the centres of both images meet.</p>\n" : ".</p>\n";
  body += spreads(comparison) + "<h2>At the belt, as they stand</h2>\n" + maps(comparison, {}) +
          "<h2>At the belt, after the best rigid motion</h2>\n" + maps(comparison, comparison.motion) +
          "<h2>Parameters</h2>\n" + parameter_table(parameters);
  return contract_io::write_file(folder / "index.html", html::page("Two calibrations compared", body));
}

}  // namespace beltpick::calibrate
