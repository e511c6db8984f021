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

// Thresholds that are known before the bits that need them get planes; bits of one threshold share them.
void PlanBuilder::place_thresholds(GrayCode& code) {
  const auto frame_of = [](const GrayBit& bit) { return bit.frame != kNone ? bit.frame : bit.twin_frame; };
  const auto waits_for = [&](const GrayBit& bit, const Threshold& wanted) {
    return bit.plane != kNone && bit.threshold == wanted;
  };
  for (const GrayBit& bit : code.bits) {
    const Threshold wanted = bit.threshold;
    if (bit.plane == kNone || wanted.kind == ThresholdKind::kTwin || wanted.level_plane != kNone) continue;
    int first = frame_of(bit);
    int last = first;
    for (const GrayBit& other : code.bits) {
      if (!waits_for(other, wanted)) continue;
      first = std::min(first, frame_of(other));
      last = std::max(last, frame_of(other));
    }
    const int level_plane = borrow_raw_plane(first, last + 1);
    const int reach_plane = borrow_raw_plane(first, last + 1);
    for (GrayBit& other : code.bits) {
      if (!waits_for(other, wanted)) continue;
      other.threshold.level_plane = level_plane;
      other.threshold.reach_plane = reach_plane;
    }
    work(first).resolve.prepare_threshold = true;
  }
}

void PlanBuilder::schedule_gray(int gray) {
  GrayCode& code = plan_.grays[static_cast<std::size_t>(gray)];
  for (int b = 0; b < static_cast<int>(code.bits.size()); ++b) {
    GrayBit& bit = code.bits[static_cast<std::size_t>(b)];
    const int frame = bit.frame != kNone ? bit.frame : bit.twin_frame;
    if (bit.threshold.kind == ThresholdKind::kTwin) {
      schedule_twins(gray, b);
    } else if (arrival(bit.threshold) < frame) {
      work(frame).resolve = {.gray = gray, .bit = b, .inverted = bit.frame == kNone};
    } else {
      bit.raw_plane = work(frame).keep_plane = add_plane(PlaneKind::kRaw);
    }
    if (bit.raw_plane == kNone) bit.plane = add_plane(PlaneKind::kBits);
  }
  place_thresholds(code);
}

}  // namespace beltpick::decode
