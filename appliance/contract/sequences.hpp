// The named pattern sequences: which frames are projected for `fast`, `standard` and `robust`.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.hpp"
#include "contract/capture.hpp"

namespace beltpick {

enum class SequenceName : std::uint8_t { kFast, kStandard, kRobust, kMicro };
enum class SequenceAxes : std::uint8_t { kColumn, kRow, kBoth };

// How files and the command line call them, in the order of the enumerators.
inline constexpr std::array<std::string_view, 4> kSequenceNames{"fast", "standard", "robust", "micro"};
inline constexpr std::array<std::string_view, 3> kSequenceAxesNames{"column", "row", "both"};

// The enumerator of a name; nothing where there is none, as for the path of a sequence.json.
std::optional<SequenceName> find_sequence_name(std::string_view name);

// The frames of a named sequence for a projector of any size, files 000.png, 001.png, ... in projection order. Every
// axis has an N-step phase, then a Gray code whose cells are about half a period wide (the complementary code). Cells
// and period are as narrow as the number of Gray frames allows, but not so narrow that defocus takes the contrast:
//   fast      5 steps, 7 Gray frames; thresholds are the phase frames' mean
//   standard  8 steps, 8 Gray frames; likewise
//   robust   12 steps, 8 Gray frames, each followed by its inverted twin; white and black before all, and white once
//             more after all, which tells what moved
//   micro     4 steps of each of 4 periods from 10 to 15 pixels and no Gray code: for shiny concave parts, whose walls
//             light each other: bounced light carries broad stripes, but not fringes as fine as these. Where their
//             phases agree on no order, it is masked. Decoding takes 19 bytes a pixel.
// A smaller projector needs fewer Gray frames. What sets a threshold comes before what needs it, so that a decoder can
// fold the frames as they arrive. Error: kValueOutOfRange where the projector has less than two periods.
Result<Sequence> make_sequence(SequenceName name, const ProjectorGrid& projector, SequenceAxes axes);

// The projected intensity of a frame where the coordinate along its axis is x, in 0..1 (a = b = 0.5). x is the pixel
// index; on a diamond lattice see lattice_coordinate.
double pattern_intensity(const FrameSpec& frame, double x);

// The coordinate along `axis` of a projector's pixel: its index, but on a diamond lattice the odd rows stand half a
// pixel further along the columns.
double lattice_coordinate(ProjectorLayout layout, Axis axis, int row, int column);

}  // namespace beltpick
