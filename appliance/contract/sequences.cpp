#include "contract/sequences.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick {
namespace {

// What distinguishes the named sequences.
struct Recipe {
  int steps;
  int gray_bits;  // at most
  bool twins;     // inverted Gray frames, white and black first, white once more last
};

constexpr Recipe recipe_of(SequenceName name) {
  switch (name) {
    case SequenceName::kFast:
      return {5, 7, false};
    case SequenceName::kStandard:
      return {8, 8, false};
    case SequenceName::kRobust:
      return {12, 8, true};
    case SequenceName::kMicro:
      return {4, 8, false};
  }
  return {};
}

// Noise goes with period / contrast, and is least at 2 pi times the blur (standard deviation): 10 pixels serve best
// what is blurred by 1.6 pixels, an object at the end of the depth of field; what is in focus gains little below it.
constexpr double kShortestPeriodPx = 10.0;
constexpr double kShortestCellPx = kShortestPeriodPx / 2.0;
// What a border of the Gray code may stand off its place, by blur, shadow or a threshold that is not quite in the
// middle, before it can shift the fringe order: a period is longer than a cell by twice this.
constexpr double kBorderSlackPx = 2.5;
constexpr double kLargestCellShare = 0.625;  // of the period, where cells are wide

// The stripes of one axis. Both may be fractional: a projector's pixels then round the borders by half a pixel.
struct Stripes {
  double cell_px;
  double period_px;
};

Stripes stripes_for(int extent, int gray_bits) {
  const double cell_px = std::max(kShortestCellPx, std::ldexp(extent, -gray_bits));
  return {cell_px, std::max(cell_px + 2.0 * kBorderSlackPx, cell_px / kLargestCellShare)};
}

// Periods whose phases together tell every place of an extent from every other, by a search for those that keep wrong
// fringe orders farthest from fitting: at 1140 pixels by 0.16 of a turn, at 1920 by 0.15.
std::span<const double> micro_periods(int extent) {
  static constexpr std::array<double, 4> kUpTo1140{10.0, 13.85, 14.15, 14.95};
  static constexpr std::array<double, 4> kUpTo1920{10.0, 14.0, 14.1, 14.85};
  static constexpr std::array<double, 5> kMore{10.0, 13.1, 14.55, 14.65, 14.85};
  if (extent <= 1140) return kUpTo1140;
  return extent <= 1920 ? std::span<const double>(kUpTo1920) : std::span<const double>(kMore);
}

int bits_for(double cells) {
  int bits = 0;
  while (std::ldexp(1.0, bits) < cells - 1e-9) ++bits;
  return bits;
}

void append_phase(Axis axis, double period_px, int steps, Sequence& sequence) {
  for (int step = 0; step < steps; ++step) {
    FrameSpec frame;
    frame.kind = FrameKind::kPhase;
    frame.axis = axis;
    frame.period_px = period_px;
    frame.steps = steps;
    frame.step = step;
    sequence.frames.push_back(frame);
  }
}

void append_gray(Axis axis, double cell_px, int bits, bool twins, Sequence& sequence) {
  for (int bit = bits - 1; bit >= 0; --bit) {
    FrameSpec frame;
    frame.kind = FrameKind::kGray;
    frame.axis = axis;
    frame.cell_px = cell_px;
    frame.bit = bit;
    sequence.frames.push_back(frame);
    if (!twins) continue;
    frame.inverted = true;
    sequence.frames.push_back(frame);
  }
}

void append_plain(FrameKind kind, Sequence& sequence) {
  FrameSpec frame;
  frame.kind = kind;
  sequence.frames.push_back(frame);
}

void name_files(Sequence& sequence) {
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "%03zu.png", i);
    sequence.frames[i].file = name;
  }
}

}  // namespace

std::optional<SequenceName> find_sequence_name(std::string_view name) {
  const auto* const at = std::find(kSequenceNames.begin(), kSequenceNames.end(), name);
  if (at == kSequenceNames.end()) return std::nullopt;
  return static_cast<SequenceName>(at - kSequenceNames.begin());
}

Result<Sequence> make_sequence(SequenceName name, const ProjectorGrid& projector, SequenceAxes axes) {
  const Recipe recipe = recipe_of(name);
  Sequence sequence;
  sequence.projector = projector;
  if (recipe.twins) {
    append_plain(FrameKind::kWhite, sequence);
    append_plain(FrameKind::kBlack, sequence);
  }
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    if (axes == (axis == Axis::kColumn ? SequenceAxes::kRow : SequenceAxes::kColumn)) continue;
    const int extent = projector.extent(axis);
    const auto [cell_px, period_px] = stripes_for(extent, recipe.gray_bits);
    if (extent < 2.0 * period_px) {
      return failure(ResultCode::kValueOutOfRange, "projector: expected at least %.0f %s, found %d; check its size",
                     std::ceil(2.0 * period_px), axis == Axis::kColumn ? "columns" : "rows", extent);
    }
    if (name == SequenceName::kMicro) {
      for (const double micro_px : micro_periods(extent)) append_phase(axis, micro_px, recipe.steps, sequence);
      continue;
    }
    append_phase(axis, period_px, recipe.steps, sequence);
    append_gray(axis, cell_px, bits_for(extent / cell_px), recipe.twins, sequence);
  }
  if (recipe.twins) append_plain(FrameKind::kWhite, sequence);
  name_files(sequence);
  return sequence;
}

double pattern_intensity(const FrameSpec& frame, double x) {
  switch (frame.kind) {
    case FrameKind::kWhite:
      return 1.0;
    case FrameKind::kBlack:
      return 0.0;
    case FrameKind::kPhase:
      return 0.5 +
             0.5 * std::cos(2 * kPi * x / frame.period_px + frame.offset_rad + 2 * kPi * frame.step / frame.steps);
    case FrameKind::kGray:
      break;
  }
  const auto cell = static_cast<std::int64_t>(std::floor((x + 0.5) / frame.cell_px));
  const bool bit = (((cell ^ (cell >> 1)) >> frame.bit) & 1) != 0;
  return bit != frame.inverted ? 1.0 : 0.0;
}

double lattice_coordinate(ProjectorLayout layout, Axis axis, int row, int column) {
  if (axis == Axis::kRow) return row;
  const bool shifted = layout == ProjectorLayout::kDiamond && row % 2 != 0;
  return column + (shifted ? 0.5 : 0.0);
}

}  // namespace beltpick
