#include "segmented_input.hpp"

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::cli {

void add_segment_choices(CLI::App& app, SegmentChoices& choices) {
  app.add_option("input", choices.input, "a capture (folder or .zip), or an organised cloud in mm (.npy)")
      ->required()
      ->type_name("CAPTURE|CLOUD");
  app.add_option("--calibration", choices.calibration, "of the capture's camera and projector")
      ->type_name("calibration.json");
  app.add_flag("--keep-touching", choices.keep_touching,
               "do not cut objects apart at the sharp concave edge where they touch");
}

Result<std::unique_ptr<SegmentedInput>> SegmentedInput::make(const SegmentChoices& choices, const Session& session) {
  contract_io::Warnings warnings;
  auto input = RangeInput::read(choices.input, choices.calibration, warnings, session.json);
  session.warn(warnings);
  if (!input) return std::unexpected(input.error());
  std::unique_ptr<SegmentedInput> made(new SegmentedInput);
  made->input_ = std::move(*input);

  Limits limits;
  limits.image_width = made->input_->range().point_mm.cols;
  limits.image_height = made->input_->range().point_mm.rows;
  limits.segments = kMaxObjects;
  Arena measuring;
  const segment::Segmenter sizes(measuring, limits, segment::CreaseCut::kAvailable);
  made->block_ = std::make_unique<ArenaBlock>(measuring.used_bytes());
  Arena arena(made->block_->data(), made->block_->bytes());
  made->segmenter_ = std::make_unique<segment::Segmenter>(arena, limits, segment::CreaseCut::kAvailable);

  const Stopwatch watch;
  made->objects_ =
      made->segmenter_->segment(made->input_->range(), {.cut_creases = !choices.keep_touching, .join_fragments = true});
  made->segment_ms_ = watch.elapsed_ms();
  if (made->objects_.left_out > 0) {
    session.warn({choices.input + ": " + std::to_string(made->objects_.left_out) + " objects beyond the limit of " +
                  std::to_string(kMaxObjects) + " were left out, the smallest [" +
                  std::string(result_code_name(ResultCode::kSegmentLimit)) + "]"});
  }
  return made;
}

}  // namespace beltpick::cli
