#include "search/trials.hpp"

namespace beltpick::search {

void Trials::add(const PartPose& T_camera_part) {
  poses_[count_] = T_camera_part;
  queries_[count_++].begin(input_.sample, input_.model, T_camera_part);
  if (count_ == kTogether) run();
}

void Trials::run() {
  const auto queries = std::span(queries_).first(count_);
  for (QualityQuery& query : queries) query.go_on(input_.sample, input_.model);
  for (std::size_t i = 0; i < count_; ++i) {
    const float bar = pool_.bar_mm();
    const float mean = queries[i].finish(input_.sample, input_.model, input_.cap_mm, bar);
    if (mean < bar) pool_.offer({poses_[i], mean});
  }
  count_ = 0;
}

}  // namespace beltpick::search
