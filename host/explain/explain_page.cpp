#include "explain/explain_page.hpp"

#include "explain/grasp_section.hpp"
#include "explain/search_section.hpp"
#include "html/page.hpp"

namespace beltpick::explain {
namespace {

using html::formatted;

// Searches shown in full beside the decisive one: an object that is nothing known is searched some twenty times, and
// explain.json has them all.
constexpr int kOthersShown = 2;

html::Tone tone_of(Fate fate) {
  return fate == Fate::kLocated ? html::Tone::kGood : fate == Fate::kWithheld ? html::Tone::kBad : html::Tone::kWarning;
}

std::string overview(const Explained& explained, const std::vector<Chapter>& chapters, Album& album) {
  std::vector<float> z_mm(explained.range.point_mm.size());
  const ImageView<float> view(z_mm.data(), explained.range.point_mm.rows, explained.range.point_mm.cols);
  for (int r = 0; r < view.rows; ++r) {
    for (int c = 0; c < view.cols; ++c) view(r, c) = explained.range.point_mm(r, c).z();
  }
  const auto& labels = explained.located.objects.labels;
  std::string html = html::figures(
      {{album.add("range.png", contract_io::range_picture(view)), "The range image: red near, blue far."},
       {album.add("labels.png", contract_io::labels_picture(labels, explained.picture)), "The segments."},
       {album.add("overlay.png", contract_io::overlay_picture(explained.picture, explained.located.found.parts,
                                                              explained.templates, explained.lens)),
        "The located parts."}});
  std::vector<std::vector<html::Cell>> rows;
  for (const Chapter& chapter : chapters) {
    rows.push_back({html::raw(formatted("<a href='#segment%d'>%d</a>", chapter.segment.label, chapter.segment.label)),
                    html::number(chapter.segment.pixels, 0),
                    html::number(static_cast<double>(chapter.searches.size()), 0),
                    html::text(fate_of(chapter, explained.located, explained.templates))});
  }
  return html + html::table({"segment", "pixels", "searches", "what became of it"}, rows);
}

std::string search_table(const Chapter& chapter) {
  std::vector<std::vector<html::Cell>> rows;
  for (const SearchStory* search : chapter.searches) {
    double strongest = 0.0;
    for (const Judged& judged : search->judged) strongest = std::max(strongest, judged.champion.strength);
    rows.push_back({html::text(search == chapter.decisive ? "decisive" : ""), html::text(route_name(search->route)),
                    html::number(static_cast<double>(search->sample.size()), 0),
                    html::number(static_cast<double>(search->primitives.size()), 0),
                    html::number(static_cast<double>(search->coarse.size()), 0),
                    html::number(static_cast<double>(search->judged.size()), 0), html::number(strongest, 3),
                    html::text(search->attempt.failed() ? std::string(search->attempt.reason.text()) : "verified")});
  }
  return html::table({"", "route", "points", "primitives", "hypotheses", "judged", "best strength", "outcome"}, rows);
}

std::string chapter_html(const Chapter& chapter, const Explained& explained, Album& album) {
  const auto& range = explained.range.point_mm;
  const Frame frame = Frame::round(chapter.segment, range.rows, range.cols);
  const std::string prefix = formatted("segment_%d", chapter.segment.label);
  std::string html = formatted("<h2 id='segment%d'>Segment %d</h2>\n", chapter.segment.label, chapter.segment.label);
  html += html::note(tone_of(chapter.fate), fate_of(chapter, explained.located, explained.templates));
  if (const std::string advice = advice_of(chapter, explained.located); !advice.empty())
    html += "<p>What can be done: " + html::escaped(advice) + ".</p>\n";
  html += html::figures(
      {{album.add(prefix + "_range.png", range_crop(explained.range, frame)), "Its range image."},
       {album.add(prefix + "_labels.png", label_crop(explained.located.objects.labels, explained.picture, frame)),
        formatted("%d pixels, up to %.1f mm above the belt%s.", chapter.segment.pixels,
                  static_cast<double>(chapter.segment.top_mm),
                  chapter.segment.touches_border ? ", reaching out of the image" : "")}});
  if (chapter.searches.empty()) return html + "<p>It was not searched.</p>\n";
  html += "<h3>Searches, in their order</h3>\n" + search_table(chapter);
  if (explained.recorder.scene() == nullptr || chapter.decisive == nullptr) return html;
  html += formatted("<h3>The decisive one: %s</h3>\n", route_name(chapter.decisive->route)) +
          search_section(*chapter.decisive, chapter.judged, frame, explained, prefix, album);
  for (const int part : chapter.parts) html += grasp_section(part, explained);
  int number = 0, shown = 0;
  for (const SearchStory* search : chapter.searches) {
    ++number;
    if (search == chapter.decisive || ++shown > kOthersShown) continue;
    html += formatted("<details><summary>Search %d: %s</summary>\n", number, route_name(search->route)) +
            search_section(*search, nullptr, frame, explained, prefix + formatted("_search_%d", number), album) +
            "</details>\n";
  }
  return html;
}

}  // namespace

Result<std::string> explanation_body(const std::filesystem::path& folder, const Explained& explained,
                                     const std::vector<Chapter>& chapters) {
  Album album;
  std::string body = overview(explained, chapters, album);
  for (const Chapter& chapter : chapters) body += chapter_html(chapter, explained, album);
  if (auto written = album.write(folder); !written) return std::unexpected(written.error());
  return body;
}

}  // namespace beltpick::explain
