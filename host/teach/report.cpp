#include "teach/report.hpp"

#include <array>
#include <cstdio>
#include <sstream>

#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "html/page.hpp"
#include "teach/part_picture.hpp"

namespace beltpick::teach {

namespace {

constexpr int kRows = 480;
constexpr int kCols = 640;
constexpr std::array kKinds{"plane", "cylinder", "sphere"};

std::vector<html::Cell> primitive_row(std::size_t index, const Primitive& p) {
  const contract_io::Rgb colour = primitive_colour(index);
  std::array<char, 120> swatch{}, direction{};
  std::snprintf(swatch.data(), swatch.size(), "<span style='background:rgb(%d,%d,%d)'>&emsp;&emsp;</span>", colour[0],
                colour[1], colour[2]);
  std::snprintf(direction.data(), direction.size(), "%.2f, %.2f, %.2f", p.direction.x(), p.direction.y(),
                p.direction.z());
  const std::string kind = kKinds[static_cast<std::size_t>(p.kind)];
  return {html::raw(swatch.data()),
          html::text(p.concave ? "concave " + kind : kind),
          html::number(p.radius_mm, 2),
          html::number(p.extent_mm, 1),
          html::number(100 * p.inlier_share, 1),
          html::text(direction.data())};
}

std::string page(const std::string& name, const Taught& taught, std::size_t views) {
  const PartTemplate& part = taught.part;
  const Vec3 size = part.box_max_mm - part.box_min_mm;
  std::ostringstream body;
  body << "<p>" << size.x() << " x " << size.y() << " x " << size.z() << " mm, " << part.point_mm.size()
       << " points about " << part.spacing_mm << " mm apart; symmetry: " << html::escaped(part.symmetry.name) << "; "
       << part.grasps.size() << " grasps (the first three are drawn).</p>\n";
  for (const std::string& warning : taught.warnings) body << html::note(html::Tone::kWarning, warning);
  for (std::size_t v = 0; v < views; ++v) {
    body << "<img style='width:32%' src='view_" << v << ".png' alt='view " << v + 1 << "'>\n";
  }
  std::vector<std::vector<html::Cell>> rows;
  for (std::size_t i = 0; i < part.primitives.size(); ++i) rows.push_back(primitive_row(i, part.primitives[i]));
  body << "<h2>Primitives, best first</h2>\n"
       << html::table({"", "kind", "radius mm", "length mm", "% of the surface", "axis or normal"}, rows);
  return html::page(name, body.str());
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
