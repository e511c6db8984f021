#include "teach/report_requirements.hpp"

#include <array>
#include <string_view>

#include "html/page.hpp"

namespace beltpick::teach {
namespace {

struct Words {
  std::string_view member, what;
};
constexpr std::array kWords{
    Words{"support", "% of what faces the camera that is measured where the pose puts it, at least"},
    Words{"coverage", "% of what light and camera can reach that is measured there, at least"},
    Words{"contradicted", "% of what was measured there that lies off the surface, at most"},
    Words{"violated", "% of the part where the camera sees that nothing is, at most"},
    Words{"sunk", "% of the part below the belt, at most"},
    Words{"unexplained", "% of the part that its own object hides, at most"},
    Words{"continued", "% of the outline beyond which the object goes on, at most"},
    Words{"residual", "RMS distance to the surface, % of what noise and template allow, at most"}};

std::string_view words_for(std::string_view member) {
  for (const Words& words : kWords) {
    if (words.member == member) return words.what;
  }
  return member;
}

}  // namespace

std::string requirement_table(const PartTemplate& part) {
  const Requirements any;
  const Requirements own = part.requirements.value_or(any);
  std::vector<std::vector<html::Cell>> rows;
  for (const RequirementMember& member : kRequirementMembers) {
    rows.push_back({html::text(words_for(member.name)), html::number(100 * (own.*member.value), 0),
                    html::number(100 * (any.*member.value), 0)});
  }
  const std::string asked =
      own == any ? "did not ask for more than any part must show" : "asked for more than any part must show";
  return "<p>Nobody needs to set these: the simulated views " + asked +
         ". A pose that shows less is withheld, with the figure that it lacks.</p>\n" +
         html::table({"what a pose must show", "this part", "any part"}, rows);
}

}  // namespace beltpick::teach
