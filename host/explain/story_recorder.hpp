// StoryRecorder: listens to a locator and keeps what it tells. Works out beside it what the locator itself has no need
// to keep: what each surface point of a pose on trial met.
#pragma once

#include <memory>
#include <vector>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "explain/story.hpp"
#include "result/drawing.hpp"

namespace beltpick::explain {

class StoryRecorder final : public pipeline::Trace {
 public:
  explicit StoryRecorder(const Limits& limits);

  [[nodiscard]] const std::vector<SearchStory>& searches() const { return searches_; }
  // What the locator judged by; the views in it are the capture's and the locator's.
  [[nodiscard]] const result::Scene* scene() const { return scene_ ? &*scene_ : nullptr; }

  void begins(const pipeline::TracedSearch& search) override;
  void primitive_found(int model_index, const Primitive& found) override;
  void aligned_coarsely(const pipeline::Candidate& candidate) override;
  void weighed(const pipeline::Candidate& candidate) override;
  void judged(const pipeline::Candidate& champion, const Result<void>& verdict) override;
  void compared(const pipeline::Candidate& champion, const pipeline::Candidate& rival,
                const result::Rivalry& rivalry) override;
  void ends(const pipeline::Attempt& attempt) override;
  void settled(const pipeline::Object& object, const pipeline::Attempt& attempt) override;

 private:
  std::vector<Looked> look_up(const pipeline::Candidate& champion);

  ArenaBlock block_;
  Arena arena_;
  result::Drawing drawing_;
  std::optional<result::Scene> scene_;
  std::span<const PartModel> models_;
  ImageView<const std::uint16_t> owner_;  // of the present search
  std::vector<RivalStory> rivals_;        // of the next to be judged
  std::vector<SearchStory> searches_;
};

}  // namespace beltpick::explain
