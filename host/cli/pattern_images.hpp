// The images behind `beltpick patterns`: a frame's pattern, and the 24-bit flash images of the LightCrafter 4500.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "contract/flash_plan.hpp"

namespace beltpick::cli {

class Progress;

// The grey levels of a frame, 0 to 255, row after row.
std::vector<std::uint8_t> draw_pattern(const FrameSpec& frame, const ProjectorGrid& projector);

// Composes the images of a plan and writes them into `folder`: bit b of a frame's level into plane first_plane + b, the
// only bit of a 1-bit frame from its level 0 or 255. Planes count from the lowest bit of green over red to blue.
Result<void> write_flash_images(const Sequence& sequence, const lcr4500::FlashPlan& plan,
                                const std::filesystem::path& folder, Progress& progress);

// "G0", "R0-R7": the planes of a place.
std::string plane_text(const FlashPlace& place);

// What lies where, how much of the projector's memory it takes, what has to be loaded and how long that takes; several
// lines for a person.
std::string flash_text(const Sequence& sequence, const lcr4500::FlashPlan& plan);

}  // namespace beltpick::cli
