#include "html/page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace beltpick::html {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.4 sans-serif;margin:2em auto;max-width:72em;padding:0 1em;color:#222}"
    "h1{font-size:1.5em}h2{font-size:1.15em;margin-top:1.8em;border-bottom:1px solid #ccc}"
    "table{border-collapse:collapse;margin:.6em 0}td,th{padding:.15em .8em;text-align:left;border-bottom:1px solid "
    "#e4e4e4}"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}"
    ".note{padding:.5em 1em;border-left:6px solid;margin:.5em 0}"
    ".good{background:#e6f4e6;border-color:#2a8a2a}.warn{background:#fff3d6;border-color:#d79a00}"
    ".bad{background:#fbe3e3;border-color:#c22}"
    ".figures{display:flex;flex-wrap:wrap;gap:1em}figure{margin:0;max-width:100%;break-inside:avoid}"
    "figcaption{font-size:.88em;color:#444;max-width:36em}svg,img{max-width:100%;height:auto}"
    "@media print{body{margin:0;font-size:11px}*{-webkit-print-color-adjust:exact;print-color-adjust:exact}"
    "tr{break-inside:avoid}h2{break-after:avoid}}";

const char* class_of(Tone tone) {
  switch (tone) {
    case Tone::kGood:
      return "good";
    case Tone::kWarning:
      return "warn";
    case Tone::kBad:
      return "bad";
  }
  return "";
}

}  // namespace

std::string formatted(const char* format, ...) {
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, again))), ' ');
  va_end(again);
  std::vsnprintf(text.data(), text.size() + 1, format, arguments);
  va_end(arguments);
  return text;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else if (c == '\'')
      result += "&#39;";
    else
      result += c;
  }
  return result;
}

std::string page(std::string_view title, std::string_view body) {
  std::string html = "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>\n<title>" + escaped(title) +
                     "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" + escaped(title) + "</h1>\n";
  html += body;
  return html + "</body></html>\n";
}

Cell text(std::string_view words) { return {"<td>" + escaped(words) + "</td>"}; }

Cell raw(std::string html) { return {"<td>" + std::move(html) + "</td>"}; }

Cell number(double value, int decimals) {
  if (!std::isfinite(value)) return {"<td class='n'>-</td>"};
  return {formatted("<td class='n'>%.*f</td>", decimals, value)};
}

std::string table(const std::vector<std::string>& heading, const std::vector<std::vector<Cell>>& rows) {
  std::string html = "<table>\n<tr>";
  for (const std::string& words : heading) html += "<th>" + escaped(words) + "</th>";
  html += "</tr>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (const Cell& cell : row) html += cell.html;
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string note(Tone tone, std::string_view words) {
  return "<p class='note " + std::string(class_of(tone)) + "'>" + escaped(words) + "</p>\n";
}

std::string figures(const std::vector<Figure>& figures) {
  std::string html = "<div class='figures'>\n";
  for (const Figure& figure : figures) {
    html += "<figure>" + figure.picture + "<figcaption>" + escaped(figure.caption) + "</figcaption></figure>\n";
  }
  return html + "</div>\n";
}

}  // namespace beltpick::html
