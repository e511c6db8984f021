#include "bench/quality/virtual_capture.hpp"

#include <stdexcept>

#include "virtual_cell/render/capture_folder.hpp"
#include "virtual_cell/render/rig_calibration.hpp"

namespace beltpick::bench {
namespace {

namespace vc = virtual_cell;

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  throw std::runtime_error(result.error().detail);
}
void need(const Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().detail);
}

}  // namespace

struct VirtualCapture::Stages {
  decode::DecoderLimits limits;
  ArenaBlock block;
  Arena arena;
  decode::Decoder decoder;
  range::Triangulator triangulator;

  explicit Stages(const decode::DecoderLimits& limits_)
      : limits(limits_),
        block(bytes_for(limits)),
        arena(block.data(), block.bytes()),
        decoder(arena, limits),
        triangulator(arena, limits.rows, limits.cols) {}

  static std::size_t bytes_for(const decode::DecoderLimits& limits) {
    Arena measuring;
    { const decode::Decoder decoder(measuring, limits); }
    { const range::Triangulator triangulator(measuring, limits.rows, limits.cols); }
    return measuring.used_bytes();
  }
};

VirtualCapture::VirtualCapture(const SceneChoice& choice) : choice_(choice), rig_(need(vc::make_rig(choice.rig))) {
  calibration_ = vc::calibrate_rig(rig_).calibration;
  if (choice.kind == SceneChoice::Kind::kPlane) choice_.render.background = vc::Background::kPlane;
  if (choice.kind == SceneChoice::Kind::kParts) {
    for (const std::string& name : choice.parts) parts_.push_back(need(vc::load_part(name)));
    maker_.emplace(parts_, rig_);
  }
  renderer_ = std::make_unique<vc::SceneRenderer>(rig_, parts_, choice_.render);
}

VirtualCapture::~VirtualCapture() = default;

void VirtualCapture::expose(const Sequence& sequence, std::uint64_t seed) {
  sequence_ = sequence;
  vc::Scene scene;
  if (maker_)
    scene = maker_->make(std::vector<vc::Lay>(static_cast<std::size_t>(choice_.parts_in_view), vc::Lay::kAny), seed);
  renderer_->place(vc::instances_of(scene, rig_), seed);
  const vc::CaptureTiming timing;
  double time_s = timing.settle_s;
  const auto size = renderer_->true_instances();
  frames_.resize(sequence_.frames.size());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    FrameSpec& frame = sequence_.frames[i];
    if (frame.exposure_us <= 0.0) frame.exposure_us = choice_.render.nominal_exposure_us;
    frames_[i].resize(size.size());
    renderer_->expose(frame, frame.exposure_us, time_s, {frames_[i].data(), size.rows, size.cols});
    time_s += 1.0 / timing.frame_rate_hz;
  }
  plan_ = need(decode::make_fold_plan(sequence_));
  stages_ = std::make_unique<Stages>(decode::limits_for(plan_, size.rows, size.cols, 1));
  need(stages_->triangulator.load(calibration_));
}

Measurement VirtualCapture::measure(bool correct_ripple) {
  plan_.correct_ripple = correct_ripple;
  const decode::DecoderLimits& limits = stages_->limits;
  need(stages_->decoder.begin(plan_, limits.rows, limits.cols, 1, 255));
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    need(stages_->decoder.fold(static_cast<int>(i), {frames_[i].data(), limits.rows, limits.cols}));
  }
  Measurement measured;
  measured.code = need(stages_->decoder.finish());
  measured.range = need(stages_->triangulator.measure(measured.code));
  return measured;
}

}  // namespace beltpick::bench
