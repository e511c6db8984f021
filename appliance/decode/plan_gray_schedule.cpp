// When each Gray bit is compared with its threshold: as soon as both are there, so that few raw frames are kept.
#include <algorithm>

#include "contract/result_codes.hpp"
#include "decode/plan_builder.hpp"

namespace beltpick::decode {

Result<void> PlanBuilder::set_threshold(GrayBit& bit, Axis axis, int exposure) {
  if (bit.frame != kNone && bit.twin_frame != kNone) {
    bit.threshold = {.kind = ThresholdKind::kTwin};
    return {};
  }
  const int frame = bit.frame != kNone ? bit.frame : bit.twin_frame;
  const double bit_us = spec(frame).exposure_us;
  double white_us = 0.0;
  const Reference reference = reference_near(bit_us, white_us);
  if (reference.white_plane != kNone && reference.black_plane != kNone) {
    const double scale = bit_us > 0.0 && white_us > 0.0 ? bit_us / white_us : 1.0;
    bit.threshold = {ThresholdKind::kMidpoint, reference.white_plane, reference.black_plane, static_cast<float>(scale)};
    return {};
  }
  const int channel = mean_channel(exposure, axis);
  if (channel == kNone) {
    return failure(ResultCode::kSequenceUndecodable,
                   "%s axis: Gray frame %d has no threshold; add its inverted twin, or a white and a black frame",
                   axis_name(axis), frame);
  }
  plan_mean(channel);
  const PhaseChannel& fringes = plan_.channels[static_cast<std::size_t>(channel)];
  const double scale = bit_us > 0.0 && fringes.exposure_us > 0.0 ? bit_us / fringes.exposure_us : 1.0;
  bit.threshold = {ThresholdKind::kMean, fringes.mean_plane, kNone, static_cast<float>(scale / fringes.frames)};
  return {};
}

Result<int> PlanBuilder::add_gray(GrayCode code, Axis axis, int exposure) {
  for (std::size_t known = 0; known < plan_.grays.size(); ++known) {
    const GrayBit& lowest = plan_.grays[known].bits.front();
    if (lowest.frame == code.bits.front().frame && lowest.twin_frame == code.bits.front().twin_frame) {
      return static_cast<int>(known);  // captured once for all exposures
    }
  }
  for (GrayBit& bit : code.bits) {
    if (auto set = set_threshold(bit, axis, exposure); !set) return std::unexpected(set.error());
  }
  plan_.grays.push_back(std::move(code));
  return static_cast<int>(plan_.grays.size()) - 1;
}

int PlanBuilder::arrival(const Threshold& threshold) const {
  int ready = plane_ready_[static_cast<std::size_t>(threshold.plane)];
  if (threshold.black_plane != kNone) {
    ready = std::max(ready, plane_ready_[static_cast<std::size_t>(threshold.black_plane)]);
  }
  return ready;
}

int PlanBuilder::borrow_raw_plane(int from_frame, int to_frame) {
  for (const Loan& loan : loans_) {
    const bool busy = std::any_of(loans_.begin(), loans_.end(), [&](const Loan& other) {
      return other.plane == loan.plane && other.from_frame < to_frame && from_frame < other.to_frame;
    });
    if (busy) continue;
    loans_.push_back({loan.plane, from_frame, to_frame});
    return loans_.back().plane;
  }
  loans_.push_back({add_plane(PlaneKind::kRaw), from_frame, to_frame});
  return loans_.back().plane;
}

void PlanBuilder::schedule_twins(int gray, int bit) {
  GrayBit& planned = plan_.grays[static_cast<std::size_t>(gray)].bits[static_cast<std::size_t>(bit)];
  const int first = std::min(planned.frame, planned.twin_frame);
  const int second = std::max(planned.frame, planned.twin_frame);
  planned.threshold.plane = work(first).keep_plane = borrow_raw_plane(first, second);
  work(second).resolve = {.gray = gray, .bit = bit, .inverted = second == planned.twin_frame};
}

void PlanBuilder::schedule_gray(int gray) {
  GrayCode& code = plan_.grays[static_cast<std::size_t>(gray)];
  int first_resolving = static_cast<int>(plan_.frames.size());
  for (int b = 0; b < static_cast<int>(code.bits.size()); ++b) {
    GrayBit& bit = code.bits[static_cast<std::size_t>(b)];
    if (bit.threshold.kind == ThresholdKind::kTwin) {
      schedule_twins(gray, b);
      first_resolving = std::min(first_resolving, std::max(bit.frame, bit.twin_frame));
      continue;
    }
    const int frame = bit.frame != kNone ? bit.frame : bit.twin_frame;
    if (arrival(bit.threshold) < frame) {
      work(frame).resolve = {.gray = gray, .bit = b, .inverted = bit.frame == kNone};
      first_resolving = std::min(first_resolving, frame);
    } else {
      bit.raw_plane = work(frame).keep_plane = add_plane(PlaneKind::kRaw);
    }
  }
  if (first_resolving == static_cast<int>(plan_.frames.size())) return;
  work(first_resolving).resolve.first = true;
  code.code_plane = add_plane(PlaneKind::kBits);
  code.weak_plane = add_plane(PlaneKind::kBits);
}

}  // namespace beltpick::decode
