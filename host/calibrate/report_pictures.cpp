#include "calibrate/report_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "html/plot.hpp"

namespace beltpick::calibrate {
namespace {

using html::formatted;

constexpr html::Colour kGrey{150, 150, 150}, kRed{190, 30, 40}, kEmpty{250, 224, 220};

const Lens& lens_of(const Outcome& outcome, Side side) {
  return side == Side::kCamera ? outcome.calibration.camera : outcome.calibration.projector;
}
const char* name_of(Side side) { return side == Side::kCamera ? "camera" : "projector"; }
const PixelPosition& place_of(const CornerOutcome& corner, Side side) {
  return side == Side::kCamera ? corner.camera_px : corner.projector_px;
}
const PixelPosition& residual_of(const CornerOutcome& corner, Side side) {
  return side == Side::kCamera ? corner.camera_residual_px : corner.projector_residual_px;
}
bool is_told(const PixelPosition& pixel) { return std::isfinite(pixel.column_px) && std::isfinite(pixel.row_px); }

html::Plot image_plot(const Outcome& outcome, Side side, const std::string& title, int width_px) {
  const Lens& lens = lens_of(outcome, side);
  const std::string name = name_of(side);
  return {title,
          {name + " column px", {-0.5, lens.width - 0.5}},
          {name + " row px", {lens.height - 0.5, -0.5}},
          true,
          width_px};
}

// Calls visit(pose, its number, corner) for every corner seen on that side.
template <class Visitor>
void each_corner(const Outcome& outcome, Side side, Visitor visit) {
  for (std::size_t p = 0; p < outcome.poses.size(); ++p) {
    for (const CornerOutcome& corner : outcome.poses[p].corners) {
      if (is_told(place_of(corner, side))) visit(outcome.poses[p], p, corner);
    }
  }
}

double distance_mm(const Outcome& outcome, const PoseOutcome& pose, const CornerOutcome& corner) {
  return (pose.T_camera_plate * outcome.board.flat_mm(corner.corner)).z();
}

std::string tip_of(const PoseOutcome& pose, std::size_t number, const CornerOutcome& corner, Side side) {
  const PixelPosition& off = residual_of(corner, side);
  return formatted("%zu: %s, corner %d, off %.3f, %.3f px", number + 1, pose.capture.c_str(), corner.corner,
                   off.column_px, off.row_px) +
         (corner.reason.empty() ? "" : ": " + corner.reason);
}

// Bars side by side, a group a pose; poses that were not used are grey.
struct BarSeries {
  std::string name;
  html::Colour colour;
  double PoseOutcome::*value;
};

html::Figure bars(const Outcome& outcome, const std::string& title, const std::string& unit,
                  const std::vector<BarSeries>& series, bool held_out_only) {
  double highest = 0.0;
  for (const PoseOutcome& pose : outcome.poses) {
    for (const BarSeries& one : series) {
      if (std::isfinite(pose.*one.value)) highest = std::max(highest, pose.*one.value);
    }
  }
  const auto poses = static_cast<double>(outcome.poses.size());
  html::Plot plot(title, {"capture, in the order given", {0.4, poses + 0.6}},
                  {unit, {0.0, highest > 0 ? 1.08 * highest : 1.0}}, false, 560, 240);
  const double width = 0.8 / static_cast<double>(series.size());
  for (std::size_t p = 0; p < outcome.poses.size(); ++p) {
    const PoseOutcome& pose = outcome.poses[p];
    if (held_out_only && !pose.held_out) continue;
    for (std::size_t s = 0; s < series.size(); ++s) {
      const double left = static_cast<double>(p) + 0.6 + width * static_cast<double>(s), height = pose.*series[s].value;
      if (!std::isfinite(height)) continue;
      plot.cell({left, 0.0}, {left + width, height}, pose.used ? series[s].colour : kGrey,
                pose.capture + formatted(": %s %.4f %s", series[s].name.c_str(), height, unit.c_str()));
    }
  }
  std::string caption;
  for (const BarSeries& one : series) {
    caption += formatted("%s%s", caption.empty() ? "Dark to light: " : ", ", one.name.c_str());
  }
  return {plot.svg(), caption + ". Grey: not used."};
}

}  // namespace

html::Figure coverage_picture(const Outcome& outcome, Side side) {
  html::Plot plot = image_plot(outcome, side, formatted("Corners in the %s's image", name_of(side)), 470);
  const CoverageGrid& grid = side == Side::kCamera ? outcome.coverage.camera : outcome.coverage.projector;
  const Lens& lens = lens_of(outcome, side);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      if (grid.counts[static_cast<std::size_t>(r * grid.columns + c)] > 0) continue;
      const double wide = static_cast<double>(lens.width) / grid.columns,
                   high = static_cast<double>(lens.height) / grid.rows;
      plot.cell({c * wide - 0.5, r * high - 0.5}, {(c + 1) * wide - 0.5, (r + 1) * high - 0.5}, kEmpty,
                "no corner here");
    }
  }
  const double near_mm = outcome.coverage.near_mm, span_mm = std::max(1.0, outcome.coverage.far_mm - near_mm);
  each_corner(outcome, side, [&](const PoseOutcome& pose, std::size_t number, const CornerOutcome& corner) {
    const PixelPosition& place = place_of(corner, side);
    const html::Point at{place.column_px, place.row_px};
    if (pose.used && corner.used) {
      plot.dot(at, 1.8, html::sequential_colour((distance_mm(outcome, pose, corner) - near_mm) / span_mm));
    } else {
      plot.ring(at, 2.5, kRed, tip_of(pose, number, corner, side));
    }
  });
  plot.scale("mm away", {near_mm, near_mm + span_mm}, false);
  return {plot.svg(), formatted("%.0f %% of the fields hold a corner; the others are tinted. Red rings: left out.",
                                100.0 * grid.share())};
}

html::Figure depth_picture(const Outcome& outcome) {
  const std::vector<int>& counts = outcome.coverage.depth_counts;
  const int most = counts.empty() ? 1 : std::max(1, *std::max_element(counts.begin(), counts.end()));
  html::Plot plot("Corners by distance",
                  {"distance from the camera mm", {outcome.coverage.near_mm, outcome.coverage.far_mm}},
                  {"corners", {0.0, 1.08 * most}}, false, 380, 240);
  const double step_mm =
      (outcome.coverage.far_mm - outcome.coverage.near_mm) / std::max<double>(1.0, static_cast<double>(counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double from_mm = outcome.coverage.near_mm + static_cast<double>(i) * step_mm;
    plot.cell({from_mm, 0.0}, {from_mm + 0.92 * step_mm, static_cast<double>(counts[i])}, html::distinct_colour(0),
              formatted("%d corners", counts[i]));
  }
  return {plot.svg(), formatted("From %.0f to %.0f mm. Outside, measurements are extrapolated.",
                                outcome.coverage.near_mm, outcome.coverage.far_mm)};
}

html::Figure tilt_picture(const Outcome& outcome) {
  double widest = 20.0;
  for (const PoseOutcome& pose : outcome.poses) {
    widest = std::max({widest, std::abs(pose.tilt_x_deg), std::abs(pose.tilt_y_deg)});
  }
  widest *= 1.1;
  html::Plot plot("How the plate was tilted", {"left - right, degrees", {-widest, widest}},
                  {"up - down, degrees", {-widest, widest}}, true, 300);
  plot.line({{-widest, 0}, {widest, 0}}, kGrey, 0.5);
  plot.line({{0, -widest}, {0, widest}}, kGrey, 0.5);
  for (std::size_t p = 0; p < outcome.poses.size(); ++p) {
    const PoseOutcome& pose = outcome.poses[p];
    if (pose.corners.empty()) continue;
    plot.dot({pose.tilt_y_deg, pose.tilt_x_deg}, 4.0, pose.used ? html::distinct_colour(0) : kGrey, pose.capture);
    plot.words({pose.tilt_y_deg + 0.03 * widest, pose.tilt_x_deg + 0.03 * widest}, std::to_string(p + 1));
  }
  return {plot.svg(),
          formatted("One dot a capture; %.0f degrees up - down, %.0f degrees left - right between the outermost.",
                    outcome.coverage.tilt_x_range_deg, outcome.coverage.tilt_y_range_deg)};
}

html::Figure residual_arrows(const Outcome& outcome, Side side) {
  const double rms_px = std::max(1e-4, side == Side::kCamera ? outcome.camera_rms_px : outcome.projector_rms_px);
  const Lens& lens = lens_of(outcome, side);
  const double enlarged = std::max(1.0, std::round(0.02 * lens.width / rms_px));
  html::Plot plot = image_plot(outcome, side, formatted("What corners are off by in the %s", name_of(side)), 470);
  each_corner(outcome, side, [&](const PoseOutcome& pose, std::size_t number, const CornerOutcome& corner) {
    const PixelPosition& at = place_of(corner, side);
    const PixelPosition& off = residual_of(corner, side);
    if (!is_told(off)) return;
    if (!pose.used || !corner.used) {
      plot.ring({at.column_px, at.row_px}, 2.5, kRed, tip_of(pose, number, corner, side));
      return;
    }
    const double length = std::hypot(off.column_px, off.row_px);
    plot.arrow({at.column_px, at.row_px}, {at.column_px + enlarged * off.column_px, at.row_px + enlarged * off.row_px},
               html::sequential_colour(0.85 * length / (3.0 * rms_px)));
  });
  return {plot.svg(),
          formatted("Observed - predicted, enlarged %.0f times; %.3f px rms an axis. Arrows that point alike in "
                    "one region tell of a lens that the model does not fit; a capture of long arrows, of one that "
                    "is bad. Red rings: left out.",
                    enlarged, rms_px)};
}

html::Figure residual_means(const Outcome& outcome, Side side) {
  constexpr int kColumns = 8, kRows = 6, kFewest = 4;
  struct Field {
    double column_px = 0.0, row_px = 0.0;
    int count = 0;
  };
  std::array<Field, static_cast<std::size_t>(kColumns) * kRows> fields{};
  const Lens& lens = lens_of(outcome, side);
  each_corner(outcome, side, [&](const PoseOutcome& pose, std::size_t, const CornerOutcome& corner) {
    const PixelPosition& at = place_of(corner, side);
    const PixelPosition& off = residual_of(corner, side);
    if (!pose.used || !corner.used || !is_told(off)) return;
    const int c = std::clamp(static_cast<int>((at.column_px + 0.5) / lens.width * kColumns), 0, kColumns - 1);
    const int r = std::clamp(static_cast<int>((at.row_px + 0.5) / lens.height * kRows), 0, kRows - 1);
    Field& field = fields[static_cast<std::size_t>(r * kColumns + c)];
    field.column_px += off.column_px;
    field.row_px += off.row_px;
    ++field.count;
  });
  double largest_px = 1e-4;
  for (Field& field : fields) {
    if (field.count < kFewest) continue;
    field.column_px /= field.count;
    field.row_px /= field.count;
    largest_px = std::max(largest_px, std::hypot(field.column_px, field.row_px));
  }
  html::Plot plot = image_plot(outcome, side, formatted("Mean by field of the %s's image", name_of(side)), 470);
  const double wide = static_cast<double>(lens.width) / kColumns, high = static_cast<double>(lens.height) / kRows;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const Field& field = fields[static_cast<std::size_t>(r * kColumns + c)];
      if (field.count < kFewest) continue;
      const double length_px = std::hypot(field.column_px, field.row_px);
      plot.cell({c * wide - 0.5, r * high - 0.5}, {(c + 1) * wide - 0.5, (r + 1) * high - 0.5},
                html::sequential_colour(length_px / largest_px),
                formatted("%.4f px of %d corners", length_px, field.count));
      const double share = 0.45 * std::min(wide, high) / largest_px;
      const html::Point middle{(c + 0.5) * wide - 0.5, (r + 0.5) * high - 0.5};
      plot.arrow(middle, {middle.x + share * field.column_px, middle.y + share * field.row_px}, {255, 255, 255});
    }
  }
  plot.scale("px", {0.0, largest_px}, false);
  return {plot.svg(),
          formatted("The mean takes the noise out: what is left is the lens's that the model does not fit, at "
                    "most %.3f px. Fields with fewer than %d corners are white.",
                    largest_px, kFewest)};
}

html::Figure residual_by_pose(const Outcome& outcome) {
  return bars(outcome, "What each capture is off by", "px rms",
              {{"camera", {40, 80, 150}, &PoseOutcome::camera_rms_px},
               {"projector", {90, 150, 200}, &PoseOutcome::projector_rms_px},
               {"between both, across the baseline", {190, 215, 235}, &PoseOutcome::stereo_rms_px}},
              false);
}

html::Figure held_out_by_pose(const Outcome& outcome) {
  html::Figure figure = bars(outcome, "Measured by a calibration made without it", "mm",
                             {{"rms", {30, 110, 60}, &PoseOutcome::held_out_rms_mm},
                              {"largest", {160, 205, 160}, &PoseOutcome::held_out_max_mm}},
                             true);
  figure.caption +=
      " Each capture is left out in turn, and its plate measured with the calibration of the others: what "
      "you may expect of a part.";
  return figure;
}

html::Figure plate_picture(const Outcome& outcome) {
  const Board& board = outcome.board;
  const double half_mm = board.square_mm / 2;
  const std::vector<double>& heights_mm = outcome.plate.height_mm;
  double largest_mm = 1e-4;
  for (const double height_mm : heights_mm) largest_mm = std::max(largest_mm, std::abs(height_mm));
  html::Plot plot("The plate, as measured",
                  {"along its columns mm", {-half_mm, board.columns * board.square_mm - half_mm}},
                  {"along its rows mm", {board.rows * board.square_mm - half_mm, -half_mm}}, true, 470);
  for (std::size_t i = 0; i < heights_mm.size(); ++i) {
    const Vec3 at_mm = board.flat_mm(static_cast<int>(i));
    plot.cell({at_mm.x() - half_mm, at_mm.y() - half_mm}, {at_mm.x() + half_mm, at_mm.y() + half_mm},
              html::diverging_colour(heights_mm[i] / largest_mm), formatted("corner %zu: %.4f mm", i, heights_mm[i]));
  }
  plot.scale("mm", {-largest_mm, largest_mm}, true);
  return {plot.svg(), formatted("%.3f mm from lowest to highest; the calibration takes it into account.%s",
                                outcome.plate.peak_to_valley_mm,
                                outcome.plate.symmetric
                                    ? " The board looks the same turned by half a turn: only what both ways have in "
                                      "common is known."
                                    : "")};
}

}  // namespace beltpick::calibrate
