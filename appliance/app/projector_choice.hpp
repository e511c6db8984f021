// The projector that the configuration names: its driver, and what it asks of a recipe.
#pragma once

#include <memory>
#include <vector>

#include "app/settings.hpp"
#include "base/result.hpp"
#include "capture/stepped_trigger.hpp"
#include "contract/capture.hpp"
#include "projector/projector_keeper.hpp"

namespace beltpick::app {

// What `projector.kind` may say.
inline constexpr const char* kEdgeProjector = "edge";
inline constexpr const char* kLcr4500Projector = "lightcrafter4500";
inline constexpr const char* kDisplayProjector = "display";

std::unique_ptr<projector::Projector> make_projector(const Settings& settings);

// The pages of a projector that leads, for the trigger that follows it.
class KeptPages : public capture::FrameShow {
 public:
  explicit KeptPages(projector::ProjectorKeeper& keeper) : keeper_(keeper) {}
  Result<std::int64_t> show(int frame) override { return keeper_.show(frame); }

 private:
  projector::ProjectorKeeper& keeper_;
};

// The lattice of the named sequences: the LightCrafter 4500's is a diamond one.
ProjectorLayout projector_layout(const Settings& settings);

// The shortest time from each frame to the next; empty where the projector asks for none. Errors: a sequence that it
// cannot show.
Result<std::vector<std::uint32_t>> projector_periods_us(const Settings& settings, const Sequence& sequence,
                                                        double settle_us);

// Whether the projector can keep the plan's timing. Error: kValueOutOfRange with what the recipe needs.
Result<void> check_projector_timing(const Settings& settings, const projector::ShowPlan& plan);

}  // namespace beltpick::app
