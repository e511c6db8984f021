#include "explain/grasp_section.hpp"

#include <array>

#include "html/page.hpp"
#include "result/grasp_choice.hpp"

namespace beltpick::explain {
namespace {

const char* words_of(result::Reach reach) {
  constexpr std::array<const char*, result::kReachCount> kWords{"can be reached",
                                                                "from below, or too flat",
                                                                "jaws or palm would meet the belt",
                                                                "the open gripper meets the part itself",
                                                                "something measured stands in the way",
                                                                "the hidden side of a located part stands in the way",
                                                                "a pick with it failed here before"};
  return kWords[static_cast<std::size_t>(reach)];
}

}  // namespace

std::string grasp_section(int part_index, const Explained& explained) {
  const auto parts = explained.located.found.parts;
  const LocatedPart& part = parts[static_cast<std::size_t>(part_index)];
  const PartModel& model = explained.models[static_cast<std::size_t>(part.template_index)];
  const PartTemplate& taught = explained.templates[static_cast<std::size_t>(part.template_index)];
  std::vector<result::Neighbour> neighbours;
  for (const LocatedPart& other : parts) {
    if (&other != &part)
      neighbours.push_back({&explained.models[static_cast<std::size_t>(other.template_index)], other.T_camera_part});
  }
  std::vector<std::vector<html::Cell>> rows;
  for (int i = 0; i < model.grasp_count; ++i) {
    const auto& grasp = model.grasps[static_cast<std::size_t>(i)];
    const auto reach = result::reach(model, grasp, part.T_camera_part, {*explained.recorder.scene(), neighbours});
    rows.push_back({html::text(i == part.grasp_index ? "chosen" : ""),
                    html::text(taught.grasps[static_cast<std::size_t>(i)].name), html::number(grasp.opening_mm, 1),
                    html::text(words_of(reach))});
  }
  return "<h4>Grasps</h4>\n" +
         html::table({"", "grasp", "opening mm", "asked in this order, on the pose as it is reported"}, rows);
}

}  // namespace beltpick::explain
