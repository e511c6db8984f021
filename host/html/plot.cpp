#include "html/plot.hpp"

#include <algorithm>
#include <cmath>

#include "html/page.hpp"

namespace beltpick::html {
namespace {

constexpr double kLeft = 62, kRight = 14, kTop = 28, kBottom = 44, kScaleWidth = 74;

std::string hex(Colour colour) { return formatted("#%02x%02x%02x", colour[0], colour[1], colour[2]); }

template <std::size_t N>
Colour between(const std::array<Colour, N>& stops, double share) {
  const double place = std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * (N - 1);
  const auto low = std::min(static_cast<std::size_t>(place), N - 2);
  Colour colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = stops[low][i] + (place - static_cast<double>(low)) * (stops[low + 1][i] - stops[low][i]);
    colour[i] = static_cast<std::uint8_t>(std::lround(value));
  }
  return colour;
}

// A round step that divides the range into about `wanted` parts.
double tick_step(const Range& range, double wanted) {
  const double rough = std::abs(range.to - range.from) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> ticks(const Range& range, double wanted) {
  std::vector<double> values;
  const double step = tick_step(range, wanted);
  if (!(step > 0.0) || !std::isfinite(step)) return values;
  const double low = std::min(range.from, range.to);
  const double high = std::max(range.from, range.to);
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) values.push_back(i * step + 0.0);
  return values;
}

}  // namespace

Colour sequential_colour(double share) {
  constexpr std::array<Colour, 5> kStops{{{48, 18, 99}, {42, 84, 140}, {33, 145, 140}, {110, 200, 86}, {250, 225, 40}}};
  return between(kStops, share);
}

Colour diverging_colour(double share) {
  constexpr std::array<Colour, 5> kStops{
      {{33, 84, 163}, {130, 176, 219}, {245, 245, 245}, {230, 150, 120}, {168, 30, 40}}};
  return between(kStops, (share + 1.0) / 2.0);
}

Colour distinct_colour(std::size_t number) {
  constexpr std::array<Colour, 10> kColours{{{31, 119, 180},
                                             {214, 39, 40},
                                             {44, 160, 44},
                                             {148, 103, 189},
                                             {255, 127, 14},
                                             {23, 162, 180},
                                             {140, 86, 75},
                                             {200, 80, 170},
                                             {110, 110, 110},
                                             {150, 150, 20}}};
  return kColours[number % kColours.size()];
}

Plot::Plot(std::string title, PlotAxis x, PlotAxis y, bool square, int width_px, int height_px)
    : title_(std::move(title)),
      x_(std::move(x)),
      y_(std::move(y)),
      plot_width_px_(width_px - kLeft - kRight),
      plot_height_px_(height_px - kTop - kBottom) {
  for (Range* range : {&x_.range, &y_.range}) {
    if (range->from == range->to) *range = {range->from - 0.5, range->to + 0.5};
  }
  if (square) {
    const double ratio = std::abs((y_.range.to - y_.range.from) / (x_.range.to - x_.range.from));
    plot_height_px_ = plot_width_px_ * ratio;
    const double tallest = 1.25 * plot_width_px_;
    if (plot_height_px_ > tallest) {
      plot_width_px_ *= tallest / plot_height_px_;
      plot_height_px_ = tallest;
    }
  }
}

double Plot::x_px(double x) const {
  return kLeft + plot_width_px_ * (x - x_.range.from) / (x_.range.to - x_.range.from);
}

double Plot::y_px(double y) const { return kTop + plot_height_px_ * (y_.range.to - y) / (y_.range.to - y_.range.from); }

void Plot::close(const char* element, std::string_view tip) {
  if (tip.empty())
    body_ += "/>\n";
  else
    body_ += "><title>" + escaped(tip) + "</title></" + element + ">\n";
}

void Plot::dot(Point at, double radius_px, Colour colour, std::string_view tip) {
  body_ += formatted("<circle cx='%.1f' cy='%.1f' r='%.1f' fill='%s'", x_px(at.x), y_px(at.y), radius_px,
                     hex(colour).c_str());
  close("circle", tip);
}

void Plot::ring(Point at, double radius_px, Colour colour, std::string_view tip) {
  body_ += formatted("<circle cx='%.1f' cy='%.1f' r='%.1f' fill='none' stroke='%s'", x_px(at.x), y_px(at.y), radius_px,
                     hex(colour).c_str());
  close("circle", tip);
}

void Plot::cell(Point low, Point high, Colour colour, std::string_view tip) {
  const double left = std::min(x_px(low.x), x_px(high.x)), top = std::min(y_px(low.y), y_px(high.y));
  // A trifle larger than the cell, so that no hairlines shine through between neighbours.
  body_ += formatted("<rect x='%.2f' y='%.2f' width='%.2f' height='%.2f' shape-rendering='crispEdges' fill='%s'", left,
                     top, std::abs(x_px(high.x) - x_px(low.x)) + 0.3, std::abs(y_px(high.y) - y_px(low.y)) + 0.3,
                     hex(colour).c_str());
  close("rect", tip);
}

void Plot::arrow(Point from, Point to, Colour colour) {
  const double x0 = x_px(from.x), y0 = y_px(from.y), x1 = x_px(to.x), y1 = y_px(to.y);
  const double length = std::hypot(x1 - x0, y1 - y0);
  body_ += formatted("<path d='M%.1f %.1fL%.1f %.1f", x0, y0, x1, y1);
  if (length > 0.5) {
    const double head = std::min(3.5, 0.5 * length);
    const double dx = head * (x1 - x0) / length, dy = head * (y1 - y0) / length;
    body_ += formatted("M%.1f %.1fL%.1f %.1fL%.1f %.1f", x1 - dx - 0.6 * dy, y1 - dy + 0.6 * dx, x1, y1,
                       x1 - dx + 0.6 * dy, y1 - dy - 0.6 * dx);
  }
  body_ += formatted("' fill='none' stroke='%s' stroke-width='1'/>\n", hex(colour).c_str());
}

void Plot::line(const std::vector<Point>& points, Colour colour, double width_px, bool dashed) {
  body_ += formatted("<polyline points='");
  for (const Point& point : points) body_ += formatted("%.1f,%.1f ", x_px(point.x), y_px(point.y));
  body_ += formatted("' fill='none' stroke='%s' stroke-width='%.1f'%s/>\n", hex(colour).c_str(), width_px,
                     dashed ? " stroke-dasharray='4 3'" : "");
}

void Plot::words(Point at, std::string_view text, Colour colour) {
  body_ += formatted("<text x='%.1f' y='%.1f' font-size='11' fill='%s'>", x_px(at.x), y_px(at.y), hex(colour).c_str());
  body_ += escaped(text) + "</text>\n";
}

void Plot::scale(std::string_view label, Range range, bool diverging) {
  constexpr int kSteps = 40;
  const double left = kLeft + plot_width_px_ + 12;
  const double step_px = plot_height_px_ / kSteps;
  scale_.clear();
  for (int i = 0; i < kSteps; ++i) {
    const double share = (i + 0.5) / kSteps;
    const Colour colour = diverging ? diverging_colour(2.0 * share - 1.0) : sequential_colour(share);
    scale_ += formatted("<rect x='%.1f' y='%.2f' width='12' height='%.2f' fill='%s'/>\n", left,
                        kTop + plot_height_px_ - (i + 1) * step_px, step_px + 0.3, hex(colour).c_str());
  }
  for (const double value : ticks(range, 5)) {
    const double y = kTop + plot_height_px_ * (range.to - value) / (range.to - range.from);
    scale_ += formatted("<text x='%.1f' y='%.1f' font-size='10'>%.3g</text>\n", left + 16, y + 3.5, value);
  }
  scale_ += formatted("<text x='%.1f' y='%.1f' font-size='10'>", left - 8, kTop - 8) + escaped(label) + "</text>\n";
}

std::string Plot::axes() const {
  std::string text = formatted(
      "<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f' fill='none' stroke='#666'/>\n"
      "<text x='%.1f' y='17' font-size='13' font-weight='bold'>",
      kLeft, kTop, plot_width_px_, plot_height_px_, kLeft);
  text += escaped(title_) + "</text>\n";
  const double bottom = kTop + plot_height_px_;
  for (const double value : ticks(x_.range, plot_width_px_ / 75)) {
    const double x = x_px(value);
    text += formatted(
        "<path d='M%.1f %.1fv4' stroke='#666'/><text x='%.1f' y='%.1f' font-size='10' "
        "text-anchor='middle'>%.6g</text>\n",
        x, bottom, x, bottom + 15, value);
  }
  for (const double value : ticks(y_.range, plot_height_px_ / 50)) {
    const double y = y_px(value);
    text += formatted(
        "<path d='M%.1f %.1fh-4' stroke='#666'/><text x='%.1f' y='%.1f' font-size='10' text-anchor='end'>%.6g</text>\n",
        kLeft, y, kLeft - 6, y + 3.5, value);
  }
  text += formatted("<text x='%.1f' y='%.1f' font-size='11' text-anchor='middle'>", kLeft + plot_width_px_ / 2,
                    bottom + 33);
  text += escaped(x_.label) + "</text>\n";
  text += formatted("<text transform='translate(14 %.1f) rotate(-90)' font-size='11' text-anchor='middle'>",
                    kTop + plot_height_px_ / 2);
  return text + escaped(y_.label) + "</text>\n";
}

std::string Plot::svg() const {
  const double width = kLeft + plot_width_px_ + kRight + (scale_.empty() ? 0.0 : kScaleWidth);
  const double height = kTop + plot_height_px_ + kBottom;
  return formatted(
             "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' viewBox='0 0 %.0f %.0f' "
             "font-family='sans-serif' fill='#222'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
             width, height, width, height) +
         body_ + axes() + scale_ + "</svg>";
}

}  // namespace beltpick::html
