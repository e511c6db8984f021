#include "explain/story_recorder.hpp"

#include <cmath>

namespace beltpick::explain {
namespace {

std::size_t drawing_bytes(const Limits& limits) {
  Arena measuring;
  const result::Drawing sizes(measuring, limits);
  return measuring.used_bytes();
}

class Collector final : public result::FindingListener {
 public:
  std::vector<Looked> looked;

  void found(const result::VisiblePoint& point, result::Finding finding) override {
    looked.push_back(
        {static_cast<int>(std::lround(point.row_px)), static_cast<int>(std::lround(point.column_px)), finding});
  }
};

}  // namespace

const char* route_name(pipeline::Effort route) {
  switch (route) {
    case pipeline::Effort::kPrimitives:
      return "by cylinders and spheres";
    case pipeline::Effort::kViews:
      return "by every view of the part";
    case pipeline::Effort::kPlanes:
      return "by one face";
    case pipeline::Effort::kPieces:
    case pipeline::Effort::kNeighbourhoods:
    case pipeline::Effort::kJoined:
    case pipeline::Effort::kJoinedNeighbourhoods:
      break;
  }
  return "by all routes";
}

StoryRecorder::StoryRecorder(const Limits& limits)
    : block_(drawing_bytes(limits)), arena_(block_.data(), block_.bytes()), drawing_(arena_, limits) {}

void StoryRecorder::begins(const pipeline::TracedSearch& search) {
  scene_ = search.scene;
  models_ = search.models;
  owner_ = search.owner;
  rivals_.clear();
  SearchStory story;
  story.object = search.object;
  story.route = search.route;
  story.sample.assign(search.sample.begin(), search.sample.end());
  searches_.push_back(std::move(story));
}

void StoryRecorder::primitive_found(int model_index, const Primitive& found) {
  searches_.back().primitives.push_back({model_index, found});
}

void StoryRecorder::aligned_coarsely(const pipeline::Candidate& candidate) {
  searches_.back().coarse.push_back(candidate);
}

void StoryRecorder::weighed(const pipeline::Candidate& candidate) { searches_.back().weighed.push_back(candidate); }

void StoryRecorder::judged(const pipeline::Candidate& champion, const Result<void>& verdict) {
  Judged judged{champion, verdict ? Error{} : verdict.error(), std::move(rivals_), look_up(champion)};
  rivals_.clear();
  searches_.back().judged.push_back(std::move(judged));
}

void StoryRecorder::compared(const pipeline::Candidate&, const pipeline::Candidate& rival,
                             const result::Rivalry& rivalry) {
  rivals_.push_back({rival, rivalry});
}

void StoryRecorder::ends(const pipeline::Attempt& attempt) { searches_.back().attempt = attempt; }

// A verified pose that gave way to a stronger one.
void StoryRecorder::settled(const pipeline::Object& object, const pipeline::Attempt& attempt) {
  if (!attempt.failed() || attempt.reason.code != ResultCode::kDuplicatePose) return;
  for (auto search = searches_.rbegin(); search != searches_.rend(); ++search) {
    if (search->object.labels[0] != object.labels[0] || !search->attempt.verified) continue;
    search->attempt = attempt;
    return;
  }
}

std::vector<Looked> StoryRecorder::look_up(const pipeline::Candidate& champion) {
  const PartModel& model = models_[static_cast<std::size_t>(champion.model_index)];
  const pipeline::Object& object = searches_.back().object;
  Collector collector;
  drawing_.draw(model.fine, champion.alignment.T_camera_part, scene_->lens);
  result::weigh(drawing_, model, champion.alignment.T_camera_part, *scene_,
                {owner_, {object.labels, static_cast<std::size_t>(object.label_count)}}, &collector);
  return std::move(collector.looked);
}

}  // namespace beltpick::explain
