#include "explain/search_section.hpp"

#include <algorithm>
#include <array>

#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract_io/image_io.hpp"
#include "explain/checks.hpp"
#include "explain/q_map_plot.hpp"
#include "pipeline/contest.hpp"

namespace beltpick::explain {
namespace {

using html::formatted;

constexpr std::size_t kMapsShown = 3;
constexpr std::size_t kRowsShown = 10;
constexpr int kLeastWidth_px = 300;
constexpr std::array kKindNames{"plane", "cylinder", "sphere"};

const PartModel& model_of(const pipeline::Candidate& candidate, const Explained& explained) {
  return explained.models[static_cast<std::size_t>(candidate.model_index)];
}
const std::string& name_of(int model_index, const Explained& explained) {
  return explained.templates[static_cast<std::size_t>(model_index)].name;
}

std::string primitives_part(const SearchStory& search, const Frame& frame, const Explained& explained,
                            const std::string& prefix, Album& album) {
  if (search.primitives.empty()) {
    return search.route == pipeline::Effort::kViews
               ? ""
               : "<h4>Primitives</h4>\n<p>None was found that a template has.</p>\n";
  }
  std::vector<std::vector<html::Cell>> rows;
  std::vector<html::Figure> figures;
  for (const FoundPrimitive& found : search.primitives) {
    const Primitive& p = found.primitive;
    const std::string kind = kKindNames[static_cast<std::size_t>(p.kind)];
    rows.push_back({html::text(name_of(found.model_index, explained)), html::text((p.concave ? "bore, " : "") + kind),
                    html::number(p.radius_mm, 2), html::number(p.extent_mm, 1), html::number(100.0 * p.inlier_share, 0),
                    html::number(p.rms_mm, 3)});
    auto inliers = inlier_crop(*explained.recorder.scene(), search.object, p, explained.picture, frame);
    figures.push_back(
        {album.add(prefix + formatted("_primitive_%zu.png", figures.size() + 1), std::move(inliers.picture)),
         formatted("%s: %d of the object's %d points lie on it (green).%s", kind.c_str(), inliers.on_it, inliers.pixels,
                   p.kind == PrimitiveKind::kCylinder ? " Red: its axis." : "")});
  }
  return "<h4>Primitives</h4>\n" +
         html::table({"looked for in", "found", "radius mm", "length mm", "of the sample %", "rms mm"}, rows) +
         html::figures(figures);
}

std::string maps_part(const SearchStory& search, const Explained& explained) {
  const auto maps = q_maps(search, explained.models);
  std::string html = "<h4>Search: Q over the poses tried</h4>\n";
  if (maps.empty()) return html + "<p>No pose was tried.</p>\n";
  int tried = 0;
  for (const QMap& map : maps) tried += map.tried;
  html += formatted("<p>%d poses, each ranked by the mean distance of %zu points to the part.%s</p>\n", tried,
                    std::min(search.sample.size(), pipeline::kSearchSample),
                    maps.size() > kMapsShown ? " The best three maps; all are in explain.json." : "");
  for (std::size_t i = 0; i < std::min(maps.size(), kMapsShown); ++i) {
    html += "<p>" + html::escaped(name_of(maps[i].model_index, explained) + ": " + maps[i].about) +
            formatted(": %d poses, least Q %.2f mm.</p>\n", maps[i].tried, maps[i].best_mm) +
            html::figures(q_map_figures(maps[i]));
  }
  return html;
}

std::string hypotheses_part(const SearchStory& search, const Explained& explained) {
  std::string html = "<h4>Hypotheses</h4>\n";
  html += formatted("<p>%zu distinct ones were aligned coarsely, %zu of them with the whole sample:</p>\n",
                    search.coarse.size(), search.weighed.size());
  std::vector<std::vector<html::Cell>> rows;
  for (std::size_t i = 0; i < std::min(search.weighed.size(), kRowsShown); ++i) {
    const pipeline::Candidate& c = search.weighed[i];
    const auto& from = c.hypothesis.T_camera_part;
    const auto& to = c.alignment.T_camera_part;
    rows.push_back({html::text(std::to_string(i + 1)), html::text(name_of(c.model_index, explained)),
                    html::number(c.hypothesis.mean_distance_mm, 2), html::number(c.impression, 2),
                    html::number((from.translation_mm - to.translation_mm).norm(), 1),
                    html::number(deg_from_rad(rotation_between_rad(from.rotation, to.rotation)), 1),
                    html::number(c.alignment.rms_mm, 3), html::number(100.0 * c.alignment.inlier_share, 0),
                    html::number(c.strength, 3)});
  }
  return html + html::table({"", "part", "Q mm", "first impression", "moved mm", "turned deg", "rms mm", "inliers %",
                             "strength"},
                            rows);
}

std::string residual_caption(const char* when, const ResidualPicture& picture) {
  return formatted(
      "%s: %.0f %% of the object within %.2f mm of the surface, those with %.3f mm RMS; median of all %.3f mm. Red "
      "outside, blue inside, black beyond.",
      when, 100.0 * picture.within_share, picture.scale_mm, picture.rms_mm, picture.median_mm);
}

std::string alignment_part(const SearchStory& search, const Judged& judged, const Frame& frame,
                           const Explained& explained, const std::string& prefix, Album& album) {
  const result::Scene& scene = *explained.recorder.scene();
  const PartModel& model = model_of(judged.champion, explained);
  const double tolerance_mm = result::surface_tolerance_mm(scene, model.spacing_mm);
  auto before = residual_crop(scene, search.object, model, judged.champion.hypothesis.T_camera_part,
                              pipeline::coarse_radius_mm(model), explained.picture, frame);
  auto after = residual_crop(scene, search.object, model, judged.champion.alignment.T_camera_part, tolerance_mm,
                             explained.picture, frame);
  const std::string words_before = residual_caption("Before alignment", before);
  const std::string words_after = residual_caption("After", after);
  return "<h4>Alignment</h4>\n" +
         html::figures({{album.add(prefix + "_before.png", std::move(before.picture)), words_before},
                        {album.add(prefix + "_after.png", std::move(after.picture)), words_after}});
}

std::string legend() {
  std::string html = "<p>";
  for (std::size_t i = 0; i < result::kFindingCount; ++i) {
    const auto finding = static_cast<result::Finding>(i);
    const Rgb colour = finding_colour(finding);
    html += formatted("<span style='color:#%02x%02x%02x'>&#9632;</span> %s &nbsp; ", colour[0], colour[1], colour[2],
                      finding_name(finding));
  }
  return html + "</p>\n";
}

html::Cell value_cell(double value, const Check& check) {
  return *check.unit == '%'   ? html::text(formatted("%.1f %%", 100.0 * value))
         : *check.unit == 'm' ? html::text(formatted("%.3f %s", value, check.unit))
                              : html::number(value, 0);
}

std::string verification_part(const Judged& judged, const Frame& frame, const Explained& explained,
                              const std::string& prefix, Album& album) {
  const result::Scene& scene = *explained.recorder.scene();
  const PartModel& model = model_of(judged.champion, explained);
  std::vector<std::vector<html::Cell>> rows;
  for (const Check& check :
       checks_of(judged.champion.evidence, result::surface_tolerance_mm(scene, model.spacing_mm), model.required)) {
    rows.push_back({html::text(check.passed() ? "yes" : "NO"), html::text(check.meaning),
                    value_cell(check.value, check), html::text(check.at_least ? "at least" : "at most"),
                    value_cell(check.limit, check)});
  }
  LocatedPart drawn;
  drawn.template_index = judged.champion.model_index;
  drawn.T_camera_part = judged.champion.alignment.T_camera_part;
  const auto overlay =
      contract_io::overlay_picture(explained.picture, {&drawn, 1}, explained.templates, explained.lens);
  return "<h4>Verification</h4>\n" + html::table({"met", "what", "value", "", "threshold"}, rows) + legend() +
         html::figures({{album.add(prefix + "_pose.png", cut(overlay, frame)), "The part drawn in the pose judged."},
                        {album.add(prefix + "_findings.png", finding_crop(judged.looked, explained.picture, frame)),
                         "What each point of its surface in sight met in the whole range image."}}) +
         (judged.verified() ? html::note(html::Tone::kGood, "Verified.")
                            : html::note(html::Tone::kBad, "Not believed: " + std::string(judged.verdict.text())));
}

std::string rivals_part(const Judged& judged, const Explained& explained) {
  if (judged.rivals.empty()) return "<p>No other pose came near enough to be compared with it.</p>\n";
  std::vector<std::vector<html::Cell>> rows;
  for (const RivalStory& story : judged.rivals) {
    const PoseDifference apart =
        difference_modulo_symmetry(judged.champion.alignment.T_camera_part, story.rival.alignment.T_camera_part,
                                   model_of(judged.champion, explained));
    const char* outcome = !story.rivalry.same_object()                                    ? "another object"
                          : pipeline::stands(judged.champion, story.rival, story.rivalry) ? "the champion prevails"
                                                                                          : "cannot be told apart";
    rows.push_back({html::text(name_of(story.rival.model_index, explained)), html::number(apart.translation_mm, 1),
                    html::number(deg_from_rad(apart.rotation_rad), 1), html::number(story.rival.strength, 3),
                    html::number(story.rivalry.only_first, 0), html::number(story.rivalry.only_second, 0),
                    html::number(story.rivalry.both, 0), html::text(outcome)});
  }
  return formatted(
             "<h4>Rivals</h4>\n<p>Poses of at least 80 %% of its strength (%.3f): pixels that only the one or "
             "the other explains.</p>\n",
             judged.champion.strength) +
         html::table({"part", "away mm", "turned deg", "strength", "only the champion's", "only the rival's", "both",
                      "outcome"},
                     rows);
}

// Small pictures in whole multiples of their size.
Picture enlarged(const Picture& small) {
  const int times = std::clamp((kLeastWidth_px + small.cols - 1) / std::max(1, small.cols), 1, 6);
  Picture large(small.rows * times, small.cols * times);
  for (int r = 0; r < large.rows; ++r) {
    for (int c = 0; c < large.cols; ++c) large.view()(r, c) = small.view()(r / times, c / times);
  }
  return large;
}

}  // namespace

std::string Album::add(const std::string& name, Picture picture) {
  pictures_.emplace_back(name, enlarged(picture));
  return formatted("<img src='%s' alt='' width='%d'>", name.c_str(), std::min(560, pictures_.back().second.cols));
}

Result<void> Album::write(const std::filesystem::path& folder) const {
  for (const auto& [name, picture] : pictures_) {
    if (auto written = contract_io::write_png(folder / name, picture.view()); !written) return written;
  }
  return {};
}

std::string search_section(const SearchStory& search, const Judged* judged, const Frame& frame,
                           const Explained& explained, const std::string& prefix, Album& album) {
  if (judged == nullptr && !search.judged.empty()) judged = &search.judged.front();
  std::string html = primitives_part(search, frame, explained, prefix, album) + maps_part(search, explained) +
                     hypotheses_part(search, explained);
  if (judged == nullptr) return html + html::note(html::Tone::kBad, std::string(search.attempt.reason.text()));
  return html + alignment_part(search, *judged, frame, explained, prefix, album) +
         verification_part(*judged, frame, explained, prefix, album) + rivals_part(*judged, explained);
}

}  // namespace beltpick::explain
