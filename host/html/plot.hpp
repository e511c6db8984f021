// A plot as inline SVG: dots, arrows, lines and coloured cells in the data's own coordinates, with axes and a scale of
// colours. Sharp on a screen and on paper.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace beltpick::html {

using Colour = std::array<std::uint8_t, 3>;

// From dark blue (0) by green to yellow (1): dark to light for whoever prints in grey. Beyond is clamped.
Colour sequential_colour(double share);
// From blue (-1) by white (0) to red (1).
Colour diverging_colour(double share);
// Colours that differ strongly, for the number of a pose.
Colour distinct_colour(std::size_t number);

struct Range {
  double from = 0.0;
  double to = 1.0;
};

struct PlotAxis {
  std::string label;  // with its unit
  Range range;        // from > to turns the axis round
};

struct Point {
  double x = 0.0;
  double y = 0.0;
};

class Plot {
 public:
  // The same scale on both axes where `square` (pictures, maps); the height then follows from `width_px`.
  Plot(std::string title, PlotAxis x, PlotAxis y, bool square, int width_px = 460, int height_px = 300);

  // `tip` is shown under the mouse.
  void dot(Point at, double radius_px, Colour colour, std::string_view tip = {});
  void ring(Point at, double radius_px, Colour colour, std::string_view tip = {});
  void cell(Point low, Point high, Colour colour, std::string_view tip = {});
  // From a point to another, with a head at its end.
  void arrow(Point from, Point to, Colour colour);
  void line(const std::vector<Point>& points, Colour colour, double width_px = 1.0, bool dashed = false);
  void words(Point at, std::string_view text, Colour colour = {34, 34, 34});
  // A bar of colours beside the plot; `diverging` or sequential.
  void scale(std::string_view label, Range range, bool diverging);

  [[nodiscard]] std::string svg() const;

 private:
  [[nodiscard]] double x_px(double x) const;
  [[nodiscard]] double y_px(double y) const;
  void close(const char* element, std::string_view tip);
  [[nodiscard]] std::string axes() const;

  std::string title_;
  PlotAxis x_, y_;
  double plot_width_px_, plot_height_px_;
  std::string body_, scale_;
};

}  // namespace beltpick::html
