// Heaps in layers, emptied over several captures: each is rendered frame by frame, decoded and located; the robot takes
// what is offered first, what lay on it settles anew, and the next capture is taken.
#include <catch2/catch.hpp>

#include "bench/pose/belt_camera.hpp"
#include "bench/pose/need.hpp"
#include "contract_io/template_io.hpp"
#include "virtual_cell/world/parts_on_belt.hpp"

using namespace beltpick;
using bench::need;
using virtual_cell::Lay;
using virtual_cell::PickOutcome;

namespace {

bench::PartPool knuckles() {
  bench::PartPool pool;
  pool.parts.push_back(need(virtual_cell::builtin_part("knuckle")));
  pool.families = {0};
  pool.twin_of = {-1};
  pool.templates.push_back(need(contract_io::read_template(BELTPICK_E2E_CELL "/knuckle.template")));
  return pool;
}

Limits small_camera() {
  Limits limits;
  limits.image_width = 640;
  limits.image_height = 480;
  return limits;
}

// What became of the heap's parts.
struct Tally {
  int captures = 0, picked = 0, blocked = 0, wrong = 0, left = 0;
};

class HeapCell {
 public:
  HeapCell()
      : pool_(knuckles()),
        machine_(small_camera(), 2),
        camera_(pool_, machine_.limits.image_width, machine_.limits.image_height),
        belt_(pool_.parts, camera_.rig()) {
    need(machine_.pipeline.load(pool_.templates));
  }

  Tally empty(std::span<const Lay> lays, std::uint64_t seed) {
    belt_.set(camera_.maker().make(lays, seed));
    Tally tally;
    for (bool picking = true; picking && !belt_.parts().empty(); ++tally.captures) {
      const bench::SeenScene seen = camera_.look(belt_.parts(), seed + static_cast<std::uint64_t>(tally.captures),
                                                 bench::Seeing::kRendered, machine_);
      const auto located = need(machine_.pipeline.locate(
          {seen.range, camera_.calibration().camera, pipeline::projector_position_mm(camera_.calibration()), 1}));
      picking = pick(located.found.parts, tally);
    }
    tally.left = static_cast<int>(belt_.parts().size());
    return tally;
  }

 private:
  // Picks in order, until a pick may have moved other parts. Whether anything was picked.
  bool pick(std::span<const LocatedPart> parts, Tally& tally) {
    const int before = tally.picked;
    bool disturbed = false;
    for (const LocatedPart& part : parts) {
      const virtual_cell::PickJudgement pick = belt_.judge(offer_of(part));
      tally.wrong += pick.outcome == PickOutcome::kCrashed && !disturbed ? 1 : 0;
      if (part.grasp_index < 0 || disturbed) continue;
      tally.blocked += pick.outcome == PickOutcome::kBlocked ? 1 : 0;
      if (pick.outcome != PickOutcome::kPicked) continue;
      belt_.remove(pick.index);
      ++tally.picked;
      disturbed = part.touches_neighbour;
    }
    return tally.picked > before;
  }

  virtual_cell::Offer offer_of(const LocatedPart& part) const {
    virtual_cell::Offer offer;
    offer.part_number = 1;
    offer.part_pose = part.T_camera_part.matrix();
    const Grasp& grasp = pool_.templates[0].grasps[static_cast<std::size_t>(std::max(0, part.grasp_index))];
    offer.gripper_pose = (part.T_camera_part * grasp.T_part_gripper).matrix();
    offer.opening_mm = grasp.opening_mm;
    return offer;
  }

  bench::PartPool pool_;
  bench::Machine machine_;
  bench::BeltCamera camera_;
  virtual_cell::PartsOnBelt belt_;
};

}  // namespace

TEST_CASE("heaps in layers are emptied over several captures, with no pose wrong and no pick in the way", "[heap]") {
  constexpr std::array kLays{Lay::kAny, Lay::kLeaning, Lay::kAny, Lay::kLeaning, Lay::kLeaning, Lay::kLeaning};
  HeapCell cell;
  int parts = 0, left = 0;
  for (const std::uint64_t seed : {401U, 402U}) {
    const Tally tally = cell.empty(kLays, seed);
    std::printf("  heap %d: %d captures, picked %d, way in blocked %d, wrong %d, left %d\n", static_cast<int>(seed),
                tally.captures, tally.picked, tally.blocked, tally.wrong, tally.left);
    CHECK(tally.wrong == 0);
    CHECK(tally.blocked == 0);
    CHECK(tally.captures >= 3);  // it was a heap
    parts += tally.picked + tally.left;
    left += tally.left;
  }
  CHECK(parts >= 10);
  CHECK(left <= 1);
}
