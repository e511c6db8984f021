#include "teach/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/units.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "html/page.hpp"
#include "teach/part_picture.hpp"
#include "teach/report_basin.hpp"
#include "teach/report_requirements.hpp"

namespace beltpick::teach {

namespace {

using html::Cell;
using html::formatted;

constexpr int kRows = 480;
constexpr int kCols = 640;
constexpr int kShownCols = 400;  // on the page
constexpr std::size_t kMostPositions = 6;
constexpr std::size_t kMostFailures = 6;
constexpr std::array kKinds{"plane", "cylinder", "sphere"};

// Writes pictures beside the page, and remembers the first failure.
class Album {
 public:
  explicit Album(std::filesystem::path folder) : folder_(std::move(folder)) {}

  html::Figure add(const std::string& name, const Picture& picture, const std::string& caption) {
    const ImageView<const contract_io::Rgb> view(picture.pixels.data(), picture.rows, picture.cols);
    auto result = contract_io::write_png(folder_ / name, view);
    if (!result && written_) written_ = std::move(result);
    return {formatted("<img src='%s' width='%d' alt='%s'>", name.c_str(), kShownCols, html::escaped(caption).c_str()),
            html::escaped(caption)};
  }
  [[nodiscard]] const Result<void>& written() const { return written_; }

 private:
  std::filesystem::path folder_;
  Result<void> written_;
};

Cell swatch(std::size_t index) {
  const contract_io::Rgb colour = primitive_colour(index);
  return html::raw(
      formatted("<span style='background:rgb(%d,%d,%d)'>&emsp;&emsp;</span>", colour[0], colour[1], colour[2]));
}

std::string direction(const Vec3& v) {
  const auto rounded = [](double x) { return std::round(100 * x) / 100 + 0.0; };  // no "-0.00"
  return formatted("%.2f, %.2f, %.2f", rounded(v.x()), rounded(v.y()), rounded(v.z()));
}

std::string primitive_table(const Taught& taught) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<Cell>> rows;
  const PartTemplate& part = taught.part;
  for (std::size_t i = 0; i < part.primitives.size(); ++i) {
    const Primitive& p = part.primitives[i];
    const PrimitiveWorth& worth = taught.worth[i];
    const bool plane = p.kind == PrimitiveKind::kPlane;
    const char* kind = kKinds[static_cast<std::size_t>(p.kind)];
    rows.push_back({swatch(i), html::number(static_cast<double>(i + 1), 0),
                    html::text(p.concave ? formatted("concave %s", kind) : kind),
                    html::number(plane ? kNone : p.radius_mm, 2),
                    html::number(p.kind == PrimitiveKind::kCylinder ? p.extent_mm : kNone, 1),
                    html::number(100 * p.inlier_share, 1), html::number(100 * worth.visible_share, 1),
                    html::number(100 * worth.visible_enough, 0), html::number(worth.alike, 0),
                    html::number(worth.freedoms, 0), html::text(direction(p.direction))});
  }
  for (std::size_t c = 0; c < part.cones.size(); ++c) {
    const TaughtCone& cone = part.cones[c];
    rows.push_back({swatch(part.primitives.size() + c), html::text(""),
                    html::text(formatted("%scone, %.0f degree", cone.concave ? "concave " : "",
                                         deg_from_rad(cone.half_angle_rad))),
                    html::number(kNone, 0), html::number(cone.to_mm - cone.from_mm, 1),
                    html::number(100 * cone.surface_share, 1), html::number(kNone, 0), html::number(kNone, 0),
                    html::number(kNone, 0), html::number(1, 0), html::text(direction(cone.direction))});
  }
  return html::table({"", "rank", "kind", "radius mm", "length mm", "% of surface", "% of what is seen",
                      "% seen well enough", "alike", "freedoms left", "axis or normal"},
                     rows);
}

std::string key_figures(const Taught& taught, const std::optional<Rehearsal>& rehearsal) {
  const PartTemplate& part = taught.part;
  const Vec3 size = part.box_max_mm - part.box_min_mm;
  const auto row = [](const char* what, const std::string& value, const char* meaning) {
    return std::vector{html::text(what), html::text(value), html::text(meaning)};
  };
  std::vector<std::vector<Cell>> rows{
      row("size", formatted("%.1f x %.1f x %.1f mm", size.x(), size.y(), size.z()), "in the mesh file's own axes"),
      row("surface points", formatted("%zu, %.2f mm apart", part.point_mm.size(), part.spacing_mm), ""),
      row("template", formatted("%.1f MB", static_cast<double>(part.point_mm.size()) * 24e-6), "on disk"),
      row("symmetry", part.symmetry.name, "turns that change nothing"),
      row("grasps", formatted("%zu", part.grasps.size()), "the first three are drawn")};
  if (rehearsal) {
    rows.push_back(row("time on this machine",
                       formatted("%.0f ms median, %.0f ms longest", rehearsal->median_ms, rehearsal->slowest_ms),
                       "from the objects to the verified pose, one core"));
    rows.push_back(row("memory of the appliance",
                       formatted("%.0f MB", 1e-6 * static_cast<double>(rehearsal->memory_bytes)),
                       "after the range image, with one template and the default limits"));
  }
  return html::table({"figure", "", ""}, rows);
}

std::string verdict(const Taught& taught, const std::optional<Rehearsal>& rehearsal) {
  std::string notes;
  if (rehearsal && !rehearsal->views.empty()) {
    const std::size_t found = rehearsal->count(Outcome::kFound);
    const std::size_t wrong = rehearsal->count(Outcome::kWrong);
    const html::Tone tone = wrong > 0                          ? html::Tone::kBad
                            : found == rehearsal->views.size() ? html::Tone::kGood
                                                               : html::Tone::kWarning;
    notes +=
        html::note(tone, formatted("Tried on %zu simulated views with %.2f mm of noise: found in %zu, ambiguous in "
                                   "%zu, withheld in %zu, wrong in %zu.",
                                   rehearsal->views.size(), rehearsal->noise_mm, found,
                                   rehearsal->count(Outcome::kAmbiguous), rehearsal->count(Outcome::kWithheld), wrong));
  }
  for (const std::string& warning : taught.warnings) notes += html::note(html::Tone::kWarning, warning);
  return notes;
}

std::string part_pictures(const Taught& taught, Album& album) {
  const std::array directions{Vec3(1, 1, -1), Vec3(-1, -0.6, 0.8), Vec3(-1, 1, -0.7),
                              Vec3(0, 0, -1), Vec3(1, 0, 0),       Vec3(0, 1, 0)};
  const std::array captions{"from the upper corner", "from below", "from the other corner",
                            "from above (-z)",       "along +x",   "along +y"};
  const std::vector<contract_io::Rgb> colours = colours_of_primitives(taught);
  std::vector<html::Figure> figures;
  for (std::size_t v = 0; v < directions.size(); ++v) {
    figures.push_back(album.add("part_" + std::to_string(v) + ".png",
                                draw_part(taught, looking_along(directions[v]), colours, 3, kRows, kCols),
                                captions[v]));
  }
  return html::figures(figures);
}

// What came of the views of one position.
std::string outcome_words(const std::optional<Rehearsal>& rehearsal, std::size_t position) {
  if (!rehearsal) return {};
  int all = 0;
  int found = 0;
  for (const RehearsedView& view : rehearsal->views) {
    if (view.resting != position) continue;
    ++all;
    found += view.outcome == Outcome::kFound ? 1 : 0;
  }
  return all == 0 ? std::string() : formatted("; found in %d of %d simulated views", found, all);
}

std::string resting_pictures(const Taught& taught, const std::optional<Rehearsal>& rehearsal, Album& album) {
  const std::vector<contract_io::Rgb> colours = colours_of_primitives(taught);
  const auto& resting = taught.part.resting;
  std::vector<html::Figure> figures;
  for (std::size_t r = 0; r < std::min(kMostPositions, resting.size()); ++r) {
    figures.push_back(album.add(
        formatted("resting_%zu.png", r), draw_part(taught, looking_along(resting[r].down), colours, 0, kRows, kCols),
        formatted("position %zu, likelihood %.0f %%, centre of gravity %.1f mm above the belt%s", r + 1,
                  100 * resting[r].likelihood, resting[r].height_mm, outcome_words(rehearsal, r).c_str())));
  }
  std::string rest;
  if (resting.size() > kMostPositions)
    rest = formatted("<p>%zu more are less likely.</p>\n", resting.size() - kMostPositions);
  return html::figures(figures) + rest;
}

std::string ambiguity_pictures(const Taught& taught, Album& album) {
  if (!taught.nearest_turn) return "<p>No turn of the part comes near to looking the same.</p>\n";
  const auto& turn = *taught.nearest_turn;
  const auto colours = colours_of_marks(moved_off(taught.surface, turn.turn, taught.symmetry_tolerance_mm));
  std::vector<html::Figure> figures;
  const std::array directions{turn.axis_direction, Vec3(-turn.axis_direction), Vec3(1, 1, -1), Vec3(-1, -0.6, 0.8)};
  for (std::size_t v = 0; v < directions.size(); ++v) {
    figures.push_back(album.add(formatted("near_turn_%zu.png", v),
                                draw_part(taught, looking_along(directions[v]), colours, 0, kRows, kCols),
                                v == 0   ? "along the axis of the turn"
                                : v == 1 ? "from the other side"
                                         : ""));
  }
  return formatted(
             "<p>A turn of %.0f degrees about (%s) leaves all but %.2f %% of the surface as it was. Only what is red "
             "tells one pose from the other: where none of it is measured, the part is withheld.</p>\n",
             deg_from_rad(turn.angle_rad), direction(turn.axis_direction).c_str(), 100 * turn.differing_share) +
         html::figures(figures);
}

std::string failure_pictures(const Taught& taught, const Rehearsal& rehearsal, Album& album) {
  const std::vector<contract_io::Rgb> colours = colours_of_primitives(taught);
  constexpr std::array kWords{"found", "ambiguous", "withheld", "wrong"};
  std::vector<html::Figure> figures;
  for (const RehearsedView& view : rehearsal.views) {
    if (view.outcome == Outcome::kFound || figures.size() == kMostFailures) continue;
    figures.push_back(album.add(formatted("failed_%zu.png", figures.size()),
                                draw_part(taught, view.truth.rotation, colours, 0, kRows, kCols),
                                formatted("position %zu: %s. %s", view.resting + 1,
                                          kWords[static_cast<std::size_t>(view.outcome)], view.why.c_str())));
  }
  if (figures.empty()) return {};
  return "<h2>Views in which it was not found</h2>\n<p>As the camera sees them.</p>\n" + html::figures(figures);
}

std::string route_table(const PartTemplate& part) {
  std::vector<std::vector<Cell>> rows;
  for (const RecognitionRoute& route : part.routes) {
    const auto index = static_cast<std::size_t>(std::max(0, route.primitive));
    rows.push_back(
        {route.primitive < 0 ? html::text("") : swatch(index),
         html::text(route.primitive < 0 ? "no primitive: all views of the part"
                                        : formatted("%zu: %s", index + 1,
                                                    kKinds[static_cast<std::size_t>(part.primitives[index].kind)])),
         html::number(100 * route.visible, 0), html::number(route.poses, 0)});
  }
  return html::table({"", "from primitive", "% of positions in which it is seen well enough", "poses to try"}, rows);
}

std::string body_of(const Taught& taught, const std::optional<Rehearsal>& rehearsal, Album& album) {
  std::string body = verdict(taught, rehearsal) + key_figures(taught, rehearsal);
  body += "<h2>The part and its primitives</h2>\n" + part_pictures(taught, album) + primitive_table(taught);
  body += "<h2>How it comes to rest</h2>\n<p>As the camera over the belt sees it.</p>\n" +
          resting_pictures(taught, rehearsal, album);
  body += "<h2>What may be taken for another pose</h2>\n" + ambiguity_pictures(taught, album);
  if (rehearsal) {
    body += failure_pictures(taught, *rehearsal, album);
    body += "<h2>How exactly it will be found</h2>\n" + accuracy_table(*rehearsal);
    body += "<h2>How far off a search may start</h2>\n" + basin_pictures(*rehearsal);
  }
  body += "<h2>When a pose is believed</h2>\n" + requirement_table(taught.part);
  return body + "<h2>Ways to recognise it</h2>\n" + route_table(taught.part);
}

}  // namespace

Result<void> write_report(const std::filesystem::path& folder, const std::string& name, const Taught& taught,
                          const std::optional<Rehearsal>& rehearsal) {
  if (auto made = contract_io::make_folder(folder); !made) return made;
  Album album(folder);
  const std::string body = body_of(taught, rehearsal, album);
  if (!album.written()) return album.written();
  return contract_io::write_file(folder / "index.html", html::page(name, body));
}

}  // namespace beltpick::teach
