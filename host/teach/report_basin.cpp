#include "teach/report_basin.hpp"

#include <array>

#include "base/units.hpp"
#include "html/page.hpp"
#include "html/plot.hpp"

namespace beltpick::teach {

namespace {

using html::formatted;

html::Figure basin_plot(const Basin& basin, bool turns) {
  const double farthest = turns ? deg_from_rad(basin.turn_rad.back()) : basin.shift_mm.back();
  html::Plot plot(turns ? "starts turned away" : "starts shifted away",
                  {turns ? "off by, degree" : "off by, mm", {0.0, farthest}}, {"came home, %", {0.0, 105.0}}, false);
  const double half_step = 0.5 * (turns ? deg_from_rad(basin.steps.turn_rad) : basin.steps.shift_mm);
  plot.line({{half_step, 0.0}, {half_step, 105.0}}, {120, 120, 120}, 1.0, true);
  const std::array axes{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const html::Colour colour = html::distinct_colour(axis);
    std::vector<html::Point> points{{0.0, 100.0}};
    for (std::size_t level = 0; level < kBasinLevels; ++level) {
      const double start = turns ? deg_from_rad(basin.turn_rad[level]) : basin.shift_mm[level];
      points.push_back({start, 100 * basin.home[axis + (turns ? 0 : 3)][level]});
    }
    plot.line(points, colour, 2.0);
    plot.words({farthest * (0.03 + 0.06 * static_cast<double>(axis)), 8.0}, axes[axis], colour);
  }
  return {plot.svg(), turns ? "about the part's axes; dashed: half the step chosen"
                            : "along the part's axes; dashed: half the step chosen"};
}

}  // namespace

std::string accuracy_table(const Rehearsal& rehearsal) {
  std::vector<std::vector<html::Cell>> rows;
  for (std::size_t k = 0; k < 6; ++k) {
    const double scale = k < 3 ? deg_from_rad(1.0) : 1.0;
    rows.push_back({html::text(kFreedomNames[k]), html::number(scale * rehearsal.rms_error[k], 4),
                    html::number(scale * rehearsal.worst_error[k], 4), html::text(k < 3 ? "degree" : "mm")});
  }
  return formatted(
             "<p>Of the poses found in %zu of %zu simulated views, %.2f mm of noise a point, about the centre of "
             "the part's box. Calibration errors come on top.</p>\n",
             rehearsal.count(Outcome::kFound), rehearsal.views.size(), rehearsal.noise_mm) +
         html::table({"freedom", "rms", "largest", ""}, rows);
}

std::string basin_pictures(const Rehearsal& rehearsal) {
  const Basin& basin = rehearsal.basin;
  if (basin.steps.turn_rad == 0.0) {
    return "<p>In none of the simulated views does the surface alone hold the part in every freedom: no steps were "
           "chosen, "
           "the appliance's own hold.</p>\n";
  }
  return html::figures({basin_plot(basin, true), basin_plot(basin, false)}) +
         formatted(
             "<p>A search in steps of %.1f degrees and %.1f mm has a pose near enough everywhere: with every "
             "freedom off at once by up to half a step, %.0f %% came home.</p>\n",
             deg_from_rad(basin.steps.turn_rad), basin.steps.shift_mm, 100 * basin.home_at_steps);
}

}  // namespace beltpick::teach
