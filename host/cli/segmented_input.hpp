// SegmentedInput: the objects of a CAPTURE or a CLOUD: what `segment` and `primitives` start from, with the same
// numbers.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "base/arena.hpp"
#include "range_input.hpp"
#include "segment/segmenter.hpp"
#include "session.hpp"

namespace beltpick::cli {

struct SegmentChoices {
  std::string input, calibration;
  bool keep_touching = false;  // do not cut at creases
};
void add_segment_choices(CLI::App& app, SegmentChoices& choices);

class SegmentedInput {
 public:
  // Objects beyond kMaxObjects are warned of. Errors: as RangeInput.
  static Result<std::unique_ptr<SegmentedInput>> make(const SegmentChoices& choices, const Session& session);

  [[nodiscard]] const RangeInput& input() const { return *input_; }
  [[nodiscard]] const segment::Segmented& objects() const { return objects_; }
  [[nodiscard]] double segment_ms() const { return segment_ms_; }

 private:
  static constexpr int kMaxObjects = 1000;

  SegmentedInput() = default;

  std::unique_ptr<RangeInput> input_;
  std::unique_ptr<ArenaBlock> block_;
  std::unique_ptr<segment::Segmenter> segmenter_;
  segment::Segmented objects_;
  double segment_ms_ = 0.0;
};

}  // namespace beltpick::cli
