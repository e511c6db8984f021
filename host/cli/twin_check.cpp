#include "twin_check.hpp"

#include <array>

#include "contract_io/template_io.hpp"
#include "progress.hpp"
#include "twins/compare.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

constexpr std::array kKinships{"strangers", "near_twins", "mirror_twins", "same"};

Json views_json(const std::vector<twins::View>& views) {
  Json list = Json::array();
  for (const twins::View& view : views) {
    // A view that no pose of the other part resembles has no bound.
    const Json difference = view.difference_mm2 < 1e9 ? Json(view.difference_mm2) : Json();
    list.push_back({{"sight", {view.sight.x(), view.sight.y(), view.sight.z()}}, {"difference_mm2", difference}});
  }
  return list;
}

Json json_of(const twins::Comparison& found, const std::string& name) {
  return {{"template", name},
          {"kinship", kKinships[static_cast<std::size_t>(found.kinship)]},
          {"differing_share", found.differing_share},
          {"largest_mm", found.largest_mm},
          {"where_mm", {found.where_mm.x(), found.where_mm.y(), found.where_mm.z()}},
          {"tolerance_mm", found.tolerance_mm},
          {"needed_mm2", found.area_needed_mm2},
          {"blind_share", found.blind_share()},
          {"taught_as_other", views_json(found.taught_as_other)},
          {"other_as_taught", views_json(found.other_as_taught)}};
}

}  // namespace

Result<TwinCheck> check_twins(const PartTemplate& part, const std::vector<std::string>& against,
                              const Session& session) {
  TwinCheck check{.answer = Json::array(), .text = {}};
  Progress progress("compare", static_cast<int>(against.size()), session.json);
  int done = 0;
  for (const std::string& path : against) {
    const auto other = contract_io::read_template(path);
    if (!other) return std::unexpected(other.error());
    const auto found = twins::compare(part, *other);
    if (!found) return std::unexpected(found.error());
    check.answer.push_back(json_of(*found, path));
    const std::string line = twins::sentence(*found, path);
    if (twins::worrying(*found)) {
      session.warn({line});
    } else {
      check.text += line + "\n";
    }
    progress.show(++done);
  }
  return check;
}

}  // namespace beltpick::cli
