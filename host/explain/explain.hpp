// The explanation of a whole capture: for every segment, stage by stage, what led to its verdict.
#pragma once

#include <filesystem>
#include <span>

#include "base/result.hpp"
#include "contract/part_template.hpp"
#include "explain/story_recorder.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::explain {

// What is explained. All views of the pipeline's last locate().
struct Explained {
  const pipeline::Located& located;
  const StoryRecorder& recorder;  // that listened to it
  std::span<const PartModel> models;
  std::span<const PartTemplate> templates;
  RangeImage range;
  ImageView<const std::uint8_t> picture;  // to draw on
  Lens lens;
  std::string capture;  // its name, for the heading
};

// Writes index.html with its pictures, and explain.json with all numbers, into `folder`, which is made. Error:
// kFileNotWritten.
Result<void> write_explanation(const std::filesystem::path& folder, const Explained& explained);

}  // namespace beltpick::explain
