#include "teach/report.hpp"

#include <array>
#include <cstdio>
#include <sstream>

#include "base/units.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "teach/part_picture.hpp"

namespace beltpick::teach {

namespace {

constexpr int kRows = 480;
constexpr int kCols = 640;
constexpr std::array kKinds{"plane", "cylinder", "sphere"};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else
      result += c;
  }
  return result;
}

std::string primitive_row(std::size_t index, const Primitive& p) {
  const contract_io::Rgb colour = primitive_colour(index);
  std::array<char, 400> row{};
  std::snprintf(
      row.data(), row.size(),
      "<tr><td style='background:rgb(%d,%d,%d)'>&nbsp;</td><td>%s%s</td><td>%.2f</td><td>%.1f</td><td>%.1f %%</td>"
      "<td>%.2f, %.2f, %.2f</td></tr>\n",
      colour[0], colour[1], colour[2], p.concave ? "concave " : "", kKinds[static_cast<std::size_t>(p.kind)],
      p.radius_mm, p.extent_mm, 100 * p.inlier_share, p.direction.x(), p.direction.y(), p.direction.z());
  return row.data();
}

std::string page(const std::string& name, const Taught& taught, std::size_t views) {
  const PartTemplate& part = taught.part;
  const Vec3 size = part.box_max_mm - part.box_min_mm;
  std::ostringstream html;
  html << "<!doctype html><meta charset='utf-8'><title>" << escaped(name)
       << "</title>\n<style>body{font:15px sans-serif;margin:2em;max-width:70em}"
       << "img{width:32%}td,th{padding:.2em .8em;text-align:left}.warn{background:#fff3d6;padding:.5em 1em}</style>\n"
       << "<h1>" << escaped(name) << "</h1>\n<p>" << size.x() << " x " << size.y() << " x " << size.z() << " mm, "
       << part.point_mm.size() << " points about " << part.spacing_mm << " mm apart; symmetry: " << part.symmetry.name
       << "; " << part.grasps.size() << " grasps (the first three are drawn).</p>\n";
  for (const std::string& warning : taught.warnings) html << "<p class='warn'>" << escaped(warning) << "</p>\n";
  for (std::size_t v = 0; v < views; ++v) html << "<img src='view_" << v << ".png' alt='view " << v + 1 << "'>\n";
  html << "<h2>Primitives, best first</h2>\n<table><tr><th></th><th>kind</th><th>radius mm</th><th>length "
          "mm</th><th>of the surface</th>"
       << "<th>axis or normal</th></tr>\n";
  for (std::size_t i = 0; i < part.primitives.size(); ++i) html << primitive_row(i, part.primitives[i]);
  html << "</table>\n";
  return html.str();
}

}  // namespace

Result<void> write_report(const std::filesystem::path& folder, const std::string& name, const Taught& taught) {
  if (auto made = contract_io::make_folder(folder); !made) return made;
  const std::array directions{Vec3(1, 1, -1), Vec3(-1, -0.6, 0.8), Vec3(-1, 1, -0.7),
                              Vec3(0, 0, -1), Vec3(1, 0, 0),       Vec3(0, 1, 0)};
  for (std::size_t v = 0; v < directions.size(); ++v) {
    const Picture picture = draw_part(taught, directions[v], kRows, kCols);
    const auto path = folder / ("view_" + std::to_string(v) + ".png");
    const ImageView<const contract_io::Rgb> view(picture.pixels.data(), picture.rows, picture.cols);
    if (auto written = contract_io::write_png(path, view); !written) return written;
  }
  return contract_io::write_file(folder / "index.html", page(name, taught, directions.size()));
}

}  // namespace beltpick::teach
