// How far off a pose may start for ICP to bring it home: measured along every freedom on simulated views, and from it
// the steps of a search that needs no one to choose them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "contract/part_model.hpp"
#include "teach/simulated_view.hpp"

namespace beltpick::teach {

// Freedoms: turns about x, y, z of the part and shifts along them, about the centre of its box.
inline constexpr std::array kFreedomNames{"turn about x",  "turn about y",  "turn about z",
                                          "shift along x", "shift along y", "shift along z"};
inline constexpr std::size_t kBasinLevels = 8;

struct Basin {
  std::size_t views = 0;                        // that hold the part in every freedom: the others tell nothing
  std::array<double, kBasinLevels> turn_rad{};  // the starts that were tried, turns ..
  std::array<double, kBasinLevels> shift_mm{};  // .. and shifts
  std::array<std::array<double, kBasinLevels>, 6> home{};  // share that came home, by freedom and start
  std::array<double, 6> reach{};  // rad or mm: the farthest start up to which nearly all came home
  SearchSteps steps;              // every freedom off at once by half of it
  double home_at_steps = 0.0;     // share that came home from there
};

// `model`: as the appliance loads it. `views` of the part, all freedoms and both ways each. Deterministic.
Basin measure_basin(const PartModel& model, std::span<const SimulatedView> views);

}  // namespace beltpick::teach
