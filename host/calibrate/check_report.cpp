#include "calibrate/check_report.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contract_io/file_io.hpp"
#include "html/page.hpp"
#include "html/plot.hpp"

namespace beltpick::calibrate {
namespace {

using html::formatted;

// What a corner is off by in a picture of the plate, in the picture's unit; NaN where it is not known.
using CornerOffset = Eigen::Vector2d (*)(const PlateCheck&, const MeasuredCorner&);

html::Plot plate_plot(const PlateCheck& check, double square_mm, const std::string& title) {
  html::Range across{0.0, 0.0}, down{0.0, 0.0};
  for (const MeasuredCorner& corner : check.corners) {
    across.to = std::max(across.to, corner.plate_mm.x());
    down.from = std::max(down.from, corner.plate_mm.y());
  }
  return html::Plot(title, {"along its columns mm", {across.from - square_mm, across.to + square_mm}},
                    {"along its rows mm", {down.from + square_mm, down.to - square_mm}}, true, 470);
}

html::Figure height_map(const PlateCheck& check, double square_mm) {
  const double half_mm = square_mm / 2.0;
  double largest_mm = 1e-4;
  for (const MeasuredCorner& corner : check.corners) largest_mm = std::max(largest_mm, std::abs(corner.above_mm));
  html::Plot plot = plate_plot(check, square_mm, "How far corners are out of one plane");
  for (const MeasuredCorner& corner : check.corners) {
    const Vec3& at_mm = corner.plate_mm;
    plot.cell({at_mm.x() - half_mm, at_mm.y() - half_mm}, {at_mm.x() + half_mm, at_mm.y() + half_mm},
              html::diverging_colour(corner.above_mm / largest_mm), formatted("%+.4f mm", corner.above_mm));
  }
  plot.scale("mm", {-largest_mm, largest_mm}, true);
  return {plot.svg(),
          formatted("Towards the camera positive, largest %.3f mm. A bow or a twist over the whole plate is "
                    "the plate's or the calibration's; single corners are noise, dirt or glare.",
                    largest_mm)};
}

html::Figure arrows(const PlateCheck& check, double square_mm, const std::string& title, const char* unit,
                    const std::string& meaning, CornerOffset offset_of) {
  double largest = 1e-6;
  for (const MeasuredCorner& corner : check.corners) {
    const double length = offset_of(check, corner).norm();
    if (!std::isnan(length)) largest = std::max(largest, length);
  }
  const double enlarged = square_mm / largest;  // the longest arrow is a square's side
  html::Plot plot = plate_plot(check, square_mm, title);
  for (const MeasuredCorner& corner : check.corners) {
    const Eigen::Vector2d off = offset_of(check, corner);
    const double length = off.norm();
    if (std::isnan(length)) continue;
    const Vec3& at_mm = corner.plate_mm;
    plot.arrow({at_mm.x(), at_mm.y()}, {at_mm.x() + enlarged * off.x(), at_mm.y() + enlarged * off.y()},
               html::sequential_colour(0.85 * length / largest));
  }
  return {plot.svg(), meaning + formatted(" The longest arrow is %.3f %s.", largest, unit)};
}

// Along the plate, in mm: measured - where both views together see the plate.
Eigen::Vector2d along_plate_mm(const PlateCheck& check, const MeasuredCorner& corner) {
  return (check.T_camera_plate.inverse() * corner.point_mm - corner.plate_mm).head<2>();
}

// An axis that is not coded tells nothing and leaves the other its own.
Eigen::Vector2d told(const PixelPosition& residual) {
  if (std::isnan(residual.column_px)) return {0.0, residual.row_px};
  if (std::isnan(residual.row_px)) return {residual.column_px, 0.0};
  return {residual.column_px, residual.row_px};
}
Eigen::Vector2d camera_px(const PlateCheck&, const MeasuredCorner& corner) { return told(corner.residual.camera_px); }
Eigen::Vector2d projector_px(const PlateCheck&, const MeasuredCorner& corner) {
  return told(corner.residual.projector_px);
}

std::string figure_table(const PlateCheck& check) {
  std::vector<std::vector<html::Cell>> rows;
  for (const CheckedFigure& figure : check.figures) {
    rows.push_back({html::text(figure.meaning), html::number(figure.value_mm, 3), html::number(figure.limit_mm, 3),
                    html::text(figure.good() ? "good" : "too much")});
  }
  return html::table({"mm", "measured", "at most", ""}, rows);
}

// Of the axes that are coded.
std::string shift_words(const PixelPosition& shift_px) {
  std::string words = "; the projector's light lies";
  const char* joined = " ";
  for (const auto& [shift, name] : {std::pair{shift_px.column_px, "columns"}, std::pair{shift_px.row_px, "rows"}}) {
    if (std::isnan(shift)) continue;
    words += joined + formatted("%+.2f %s", shift, name);
    joined = ", ";
  }
  return words + " from where the calibration has it";
}

std::string pictures(const PlateCheck& check, double square_mm) {
  return html::figures(
      {height_map(check, square_mm),
       arrows(
           check, square_mm, "What corners are off by along the plate", "mm",
           "Measured - where camera and projector together see the plate. Arrows that spread from the middle tell of "
           "a plate measured too large, those that all point alike of a view that has turned.",
           along_plate_mm),
       arrows(check, square_mm, "What corners are off by in the camera", "px",
              "Seen - predicted, in camera pixels, drawn on the plate. Without order: noise; in order: the camera's "
              "lens or focus has changed.",
              camera_px),
       arrows(check, square_mm, "What the light is off by in the projector", "px",
              "Seen - predicted, in projector pixels, drawn on the plate. All alike: projector or camera has turned "
              "since the calibration.",
              projector_px)});
}

}  // namespace

Result<void> write_check_report(const std::filesystem::path& folder, const CheckedFiles& files, const PlateCheck& check,
                                double square_mm) {
  if (auto made = contract_io::make_folder(folder); !made) return made;
  std::string body = html::note(check.good() ? html::Tone::kGood : html::Tone::kBad, check.verdict());
  body += "<p>Capture: " + html::escaped(files.capture) + "; calibration: " + html::escaped(files.calibration);
  body += formatted(". %zu corners, the plate %.0f mm away, tilted by %.0f degrees.</p>\n", check.corners.size(),
                    check.distance_mm, check.tilt_deg);
  body += figure_table(check);
  body += formatted("<p>Size %+.3f mm and distance %+.3f mm (measured - true)", check.size_error_mm,
                    check.distance_error_mm);
  body += shift_words(check.projector_shift_px) + ".</p>\n";
  body += pictures(check, square_mm);
  return contract_io::write_file(folder / "index.html", html::page("Does the calibration still hold?", body));
}

}  // namespace beltpick::calibrate
