#include "explain/q_map_plot.hpp"

#include <algorithm>
#include <limits>

#include "html/plot.hpp"

namespace beltpick::explain {
namespace {

using html::formatted;

html::Range span_of(const QPanel& panel, double QPanel::Cell::*value, double step) {
  html::Range range{std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()};
  for (const QPanel::Cell& cell : panel.cells) {
    range.from = std::min(range.from, cell.*value - 0.5 * step);
    range.to = std::max(range.to, cell.*value + 0.5 * step);
  }
  return range;
}

const QPanel::Cell* least_of(const QPanel& panel) {
  const auto least = std::min_element(panel.cells.begin(), panel.cells.end(), [](const auto& a, const auto& b) {
    return a.mean_distance_mm < b.mean_distance_mm;
  });
  return least == panel.cells.end() ? nullptr : &*least;
}

html::Range q_range(const QMap& map) {
  html::Range range{map.best_mm, map.best_mm};
  for (const QPanel& panel : map.panels) {
    for (const QPanel::Cell& cell : panel.cells) range.to = std::max(range.to, cell.mean_distance_mm);
  }
  if (range.to - range.from < 1e-6) range.to = range.from + 1.0;
  return range;
}

html::Figure figure_of(const QMap& map, const QPanel& panel, const html::Range& q) {
  const double x_step = panel.scattered ? 12.0 : panel.x_step, y_step = panel.scattered ? 12.0 : panel.y_step;
  html::Plot plot("Q, " + panel.title, {panel.x_label, span_of(panel, &QPanel::Cell::x, x_step)},
                  {panel.y_label, span_of(panel, &QPanel::Cell::y, y_step)}, false, 500, 340);
  for (const QPanel::Cell& cell : panel.cells) {
    const auto colour = html::sequential_colour((cell.mean_distance_mm - q.from) / (q.to - q.from));
    const std::string tip = formatted("%.1f, %.1f: Q = %.2f mm", cell.x, cell.y, cell.mean_distance_mm);
    if (panel.scattered)
      plot.dot({cell.x, cell.y}, 8.0, colour, tip);
    else
      plot.cell({cell.x - 0.5 * x_step, cell.y - 0.5 * y_step}, {cell.x + 0.5 * x_step, cell.y + 0.5 * y_step}, colour,
                tip);
  }
  std::string caption = "No pose.";
  if (const QPanel::Cell* least = least_of(panel)) {
    plot.ring({least->x, least->y}, 9.0, {225, 30, 30}, "least");
    caption = formatted("Least Q here %.2f mm, at %.1f mm and %.0f degrees; of the whole map %.2f mm.",
                        least->mean_distance_mm, least->x, least->y, map.best_mm);
    if (panel.scattered || panel.y_label.find("degrees") == std::string::npos) {
      caption = formatted("Least Q here %.2f mm, at (%.0f, %.0f); of the whole map %.2f mm.", least->mean_distance_mm,
                          least->x, least->y, map.best_mm);
    }
  }
  plot.scale("Q, mm", q, false);
  return {plot.svg(), caption};
}

}  // namespace

std::vector<html::Figure> q_map_figures(const QMap& map) {
  const html::Range q = q_range(map);
  std::vector<html::Figure> figures;
  for (const QPanel& panel : map.panels) {
    if (!panel.cells.empty()) figures.push_back(figure_of(map, panel, q));
  }
  return figures;
}

}  // namespace beltpick::explain
