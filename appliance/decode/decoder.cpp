#include "decode/decoder.hpp"

#include <algorithm>
#include <cassert>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "decode/repeat_row.hpp"
#include "decode/ripple.hpp"

namespace beltpick::decode {
namespace {

std::size_t pixel_count(const DecoderLimits& limits) {
  return static_cast<std::size_t>(limits.rows) * static_cast<std::size_t>(limits.cols);
}

// A channel that could not be measured, as of a coarse period in part, ripples as another of as many steps does: it is
// one projector's.
void borrow_ripple(const FoldPlan& plan, std::size_t channel, std::span<Ripple> ripples) {
  const PhaseChannel& fringes = plan.channels[channel];
  if (ripples[channel].orders > 0 || fringes.equal_steps == 0) return;
  for (std::size_t other = 0; other < plan.channels.size(); ++other) {
    if (ripples[other].orders == 0 || plan.channels[other].equal_steps != fringes.equal_steps) continue;
    ripples[channel] = ripples[other];
    ripples[channel].offset_turns = static_cast<float>(fringes.offset_rad / (2.0 * kPi));
    return;
  }
}

}  // namespace

DecoderLimits limits_for(const FoldPlan& plan, int rows, int cols, int pixel_bytes) {
  return {rows,
          cols,
          plan.state_bytes(pixel_bytes),
          plan.codes(Axis::kColumn),
          plan.codes(Axis::kRow),
          static_cast<int>(plan.frames.size())};
}

Decoder::Decoder(Arena& arena, const DecoderLimits& limits) : limits_(limits) {
  const std::size_t pixels = pixel_count(limits);
  context_.store = PlaneStore(arena.take_scratch<std::byte>(
      Phase::kMeasure, "decode state", PlaneStore::bytes_for(limits.rows, limits.cols, limits.state_bytes)));
  scratch_ = RowScratch(arena, limits.cols);
  // A channel has three frames at least.
  context_.ripples = arena.take<Ripple>("ripples", static_cast<std::size_t>(limits.frames / 3 + 1));
  check_ = FrameCheck(arena, limits.rows, limits.cols, limits.frames);
  const std::size_t codes = limits.band_rows == 0 ? pixels
                                                  : static_cast<std::size_t>(std::min(limits.band_rows, limits.rows)) *
                                                        static_cast<std::size_t>(limits.cols);
  if (limits.codes_columns) column_px_ = arena.take_scratch<float>(Phase::kMeasure, "code image", codes);
  if (limits.codes_rows) row_px_ = arena.take_scratch<float>(Phase::kMeasure, "code image", codes);
  modulation_ = arena.take_scratch<float>(Phase::kMeasure, "code image", codes);
  texture_ = arena.take<std::uint8_t>("texture", pixels);  // the range image goes on with it
  state_ = arena.take_scratch<PixelState>(Phase::kMeasure, "code image", pixels);
}

Result<void> check_fit(const FoldPlan& plan, const DecoderLimits& limits, int rows, int cols, int pixel_bytes) {
  if (cols > limits.cols || rows > limits.rows) {
    return failure(ResultCode::kLimitExceeded, "images of %dx%d exceed the declared %dx%d", cols, rows, limits.cols,
                   limits.rows);
  }
  if (plan.planes.size() > PlaneStore::kMaxPlanes) {
    return failure(ResultCode::kLimitExceeded,
                   "the sequence takes %zu images to decode, expected at most %zu; take it at fewer exposures",
                   plan.planes.size(), PlaneStore::kMaxPlanes);
  }
  if (plan.state_bytes(pixel_bytes) > limits.state_bytes) {
    return failure(ResultCode::kLimitExceeded,
                   "the sequence takes %d bytes a pixel to decode, declared are %d; set limits.decode_bytes = %d",
                   plan.state_bytes(pixel_bytes), limits.state_bytes, plan.state_bytes(pixel_bytes));
  }
  if (static_cast<int>(plan.frames.size()) > limits.frames) {
    return failure(ResultCode::kLimitExceeded, "the sequence has %zu frames, declared are %d; set limits.frames = %zu",
                   plan.frames.size(), limits.frames, plan.frames.size());
  }
  if ((plan.codes(Axis::kColumn) && !limits.codes_columns) || (plan.codes(Axis::kRow) && !limits.codes_rows)) {
    return failure(ResultCode::kLimitExceeded,
                   "the sequence codes projector %s, which the declared limits leave out; set limits.code_rows = "
                   "true, or choose another sequence",
                   plan.codes(Axis::kRow) && !limits.codes_rows ? "rows" : "columns");
  }
  return {};
}

Result<void> Decoder::begin(const FoldPlan& plan, int rows, int cols, int pixel_bytes, int full_scale) {
  if (const auto fits = check_fit(plan, limits_, rows, cols, pixel_bytes); !fits) return fits;
  if (!context_.store.place(plan, rows, cols, pixel_bytes)) {
    return failure(ResultCode::kLimitExceeded, "the sequence's planes do not fit the declared %d bytes a pixel",
                   limits_.state_bytes);
  }
  context_.plan = &plan;
  context_.rows = rows;
  context_.cols = cols;
  context_.full_scale = full_scale;
  context_.twin_margins = twin_margins(context_.to_level8());
  context_.midpoint_reaches = midpoint_reaches(context_.to_level8());
  rows_ = rows;
  pixel_bytes_ = pixel_bytes;
  next_frame_ = 0;
  check_.begin(rows, cols);
  return {};
}

template <class Pixel>
Result<void> Decoder::fold_any(int index, ImageView<const Pixel> image) {
  if (image.rows != rows_ || image.cols != context_.cols || sizeof(Pixel) != static_cast<std::size_t>(pixel_bytes_)) {
    return failure(ResultCode::kFrameWrongSize, "frame %d: expected %dx%d of %d bits, found %dx%d of %d bits", index,
                   context_.cols, rows_, 8 * pixel_bytes_, image.cols, image.rows, 8 * static_cast<int>(sizeof(Pixel)));
  }
  if (index != next_frame_ || index >= static_cast<int>(context_.plan->frames.size())) {
    return failure(index < next_frame_ ? ResultCode::kFrameDuplicated : ResultCode::kFrameMissing,
                   "expected frame %d of the sequence, found frame %d", next_frame_, index);
  }
  const FrameWork& work = context_.plan->frames[static_cast<std::size_t>(index)];
  for (int row = 0; row < rows_; ++row) {
    fold_row(context_, work, image.row(row), row);
    check_.sample_row(index, row, image.row(row));
  }
  check_.sample_lines(index, image);
  fold_repeated(index, image);
  ++next_frame_;
  return {};
}

template <class Pixel>
void Decoder::fold_repeated(int index, ImageView<const Pixel> image) {
  const RepeatedPattern& repeated = context_.plan->repeated;
  if (repeated.plane == kNone || (index != repeated.first && index != repeated.last)) return;
  for (int row = 0; row < rows_; ++row) {
    auto* kept = context_.store.row<Pixel>(repeated.plane, row);
    if (index == repeated.first) {
      std::copy_n(image.row(row), context_.cols, kept);
    } else {
      subtract_first_row(image.row(row), context_.cols, kept);
    }
  }
}

template <class Pixel>
void Decoder::mark_moved(int row, const RowOutput& out) {
  const int plane = context_.plan->repeated.plane;
  if (plane == kNone) return;
  mark_moved_row(context_.store.row<const Pixel>(plane, row), out.texture, context_.cols, context_.to_level8(),
                 out.state, out.x_px[0], out.x_px[1]);
}

Result<void> Decoder::fold(int index, ImageView<const std::uint8_t> image) { return fold_any(index, image); }
Result<void> Decoder::fold(int index, ImageView<const std::uint16_t> image) { return fold_any(index, image); }

std::size_t Decoder::code_at(int row, int first) const {
  const bool all = limits_.band_rows == 0 || limits_.band_rows >= rows_;
  return static_cast<std::size_t>(all ? row : row - first) * static_cast<std::size_t>(context_.cols);
}

CodeImage Decoder::output(int first, int end) const {
  const std::size_t codes_at = code_at(first, first);
  const std::size_t at = static_cast<std::size_t>(first) * static_cast<std::size_t>(context_.cols);
  const auto view = [&](auto memory, std::size_t start) {
    return ImageView(memory.data() + start, end - first, context_.cols);
  };
  CodeImage code;
  if (context_.plan->codes(Axis::kColumn)) code.column_px = view(column_px_, codes_at);
  if (context_.plan->codes(Axis::kRow)) code.row_px = view(row_px_, codes_at);
  code.modulation = view(modulation_, codes_at);
  code.texture = view(texture_, at);
  code.state = view(state_, at);
  code.column_noise = code_noise(*context_.plan, Axis::kColumn);
  code.row_noise = code_noise(*context_.plan, Axis::kRow);
  return code;
}

Result<CodeImage> Decoder::begin_finish() {
  const auto frames = static_cast<int>(context_.plan->frames.size());
  if (next_frame_ != frames) {
    return failure(ResultCode::kFrameMissing, "the capture ended after %d of %d frames", next_frame_, frames);
  }
  if (auto judged = check_.judge(*context_.plan, context_.full_scale); !judged) return std::unexpected(judged.error());
  measure_ripples();
  measure_contrasts();
  return output(0, rows_);
}

void Decoder::measure_ripples() {
  const FoldPlan& plan = *context_.plan;
  for (std::size_t c = 0; c < plan.channels.size(); ++c) {
    Ripple& ripple = context_.ripples[c] = {};
    if (!plan.correct_ripple) continue;
    ripple = pixel_bytes_ == 1 ? measure_ripple<std::uint8_t>(context_, scratch_, static_cast<int>(c))
                               : measure_ripple<std::uint16_t>(context_, scratch_, static_cast<int>(c));
  }
  for (std::size_t c = 0; c < plan.channels.size(); ++c) borrow_ripple(plan, c, context_.ripples);
}

void Decoder::measure_contrasts() {
  const auto& exposures = context_.plan->exposures;
  for (std::size_t e = 0; e < exposures.size(); ++e) {
    for (std::size_t a = 0; a < 2; ++a) {
      const AxisPlan& axis = exposures[e].axes[a];
      context_.usual_contrast[e][a] = pixel_bytes_ == 1
                                          ? measure_contrast<std::uint8_t>(context_, scratch_, exposures[e], axis)
                                          : measure_contrast<std::uint16_t>(context_, scratch_, exposures[e], axis);
    }
  }
}

CodeImage Decoder::finish_rows(int first, int end) {
  assert(limits_.band_rows == 0 || end - first <= limits_.band_rows);
  const bool columns = context_.plan->codes(Axis::kColumn);
  const bool rows = context_.plan->codes(Axis::kRow);
  for (int row = first; row < end; ++row) {
    const std::size_t codes_at = code_at(row, first);
    const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(context_.cols);
    const RowOutput out{{columns ? &column_px_[codes_at] : nullptr, rows ? &row_px_[codes_at] : nullptr},
                        &modulation_[codes_at],
                        &state_[at],
                        &texture_[at]};
    if (pixel_bytes_ == 1) {
      finish_row<std::uint8_t>(context_, scratch_, row, out);
      mark_moved<std::uint8_t>(row, out);
    } else {
      finish_row<std::uint16_t>(context_, scratch_, row, out);
      mark_moved<std::uint16_t>(row, out);
    }
  }
  return output(first, end);
}

Result<CodeImage> Decoder::finish() {
  auto code = begin_finish();
  if (code) finish_rows(0, rows_);
  return code;
}

}  // namespace beltpick::decode
