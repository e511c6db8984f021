// The reports' common form: one HTML file that carries its style and pictures, for a screen and for paper.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace beltpick::html {

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

// `text` with <, >, & and quotes written so that a browser shows them.
std::string escaped(std::string_view text);

// A whole document; `body` is HTML.
std::string page(std::string_view title, std::string_view body);

// A row a line, the first one the heading. Cells are text, except where the caller wraps HTML by raw().
struct Cell {
  std::string html;
};
Cell text(std::string_view words);
Cell raw(std::string html);
// With `decimals` after the point; "-" for what is no number.
Cell number(double value, int decimals);
std::string table(const std::vector<std::string>& heading, const std::vector<std::vector<Cell>>& rows);

// A sentence that must not be overlooked: good, a warning, bad.
enum class Tone { kGood, kWarning, kBad };
std::string note(Tone tone, std::string_view words);

// Pictures side by side, each with its caption.
struct Figure {
  std::string picture;  // HTML: an SVG or an img
  std::string caption;
};
std::string figures(const std::vector<Figure>& figures);

}  // namespace beltpick::html
