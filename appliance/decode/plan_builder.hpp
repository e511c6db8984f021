// PlanBuilder: puts the pieces of a FoldPlan together. Internal to decode.
#pragma once

#include <optional>
#include <vector>

#include "decode/plan_parts.hpp"

namespace beltpick::decode {

class PlanBuilder {
 public:
  // `together`: at most so many phase frames are added in one go; more take more memory and less time.
  PlanBuilder(const Sequence& sequence, ExposureRanks ranks, int together);

  Result<FoldPlan> build();

 private:
  Result<void> plan_exposure(int exposure);
  Result<void> plan_axis(int exposure, Axis axis, AxisPlan& axis_plan);
  Result<void> choose_method(const std::vector<PhaseFit>& fits, const GrayCode& code, Axis axis, AxisPlan& axis_plan);
  int add_channel(const PhaseFit& fit);
  void group_frames(const PhaseFit& fit);
  Result<int> add_gray(GrayCode code, Axis axis, int exposure);
  Result<void> set_threshold(GrayBit& bit, Axis axis, int exposure);
  // The channel whose mean serves as threshold: the finest of the axis, else of the other one; kNone without fringes.
  int mean_channel(int exposure, Axis axis) const;
  Reference reference_near(double exposure_us, double& white_us) const;
  int reference_plane(FrameKind kind, double exposure_us, double& found_us) const;
  void plan_reference(int exposure);
  void plan_mean(int channel);
  void watch_extremes(const GrayCode& code, Reference& reference);
  // Plans when each bit is resolved: as soon as its frame and its threshold are there, else at the end.
  void schedule_gray(int gray);
  void schedule_twins(int gray, int bit);
  void place_thresholds(GrayCode& code);
  int arrival(const Threshold& threshold) const;
  int add_plane(PlaneKind kind);
  int borrow_raw_plane(int from_frame, int to_frame);
  FrameWork& work(int frame) { return plan_.frames[static_cast<std::size_t>(frame)]; }
  const FrameSpec& spec(int frame) const { return plan_.sequence.frames[static_cast<std::size_t>(frame)]; }

  FoldPlan plan_;
  int together_;
  ExposureRanks ranks_;
  std::vector<int> plane_ready_;  // by plane: the frame after which its content is whole
  struct Loan {
    int plane, from_frame, to_frame;
  };
  std::vector<Loan> loans_;  // raw planes that frames wait in, shared where their times do not overlap
};

}  // namespace beltpick::decode
