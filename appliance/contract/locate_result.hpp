// What locate finds in one capture: result.json.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"

namespace beltpick {

enum class PoseStatus : std::uint8_t { kVerified, kAmbiguous };
enum class Stage : std::uint8_t { kCapture, kDecode, kRange, kSegment, kPrimitives, kSearch, kIcp, kVerify, kRank };

// Plain data of fixed size: made by threads that may not allocate.
struct LocatedPart {
  int template_index = 0;
  std::uint16_t segment = 0;
  PoseStatus status = PoseStatus::kVerified;
  Pose<frame::Camera, frame::Part> T_camera_part;
  int grasp_index = -1;            // into the template's grasps; -1: none is reachable
  double rms_mm = 0.0;             // inliers to the surface
  double coverage = 0.0;           // share of what should be visible that was measured where the pose says
  double free_space_share = 0.0;   // share of it that was seen to be empty
  double score = 0.0;              // 0..1
  double top_mm = 0.0;             // height of its highest point above the belt
  double hidden_share = 0.0;       // of what lies inside the image, what something measured in front hides
  Error not_offered{};             // why no grasp of it is offered; kOk where one is
  bool touches_neighbour = false;  // picking it may move another part: capture again after
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

struct WithheldObject {
  std::uint16_t segment = 0;
  Stage stage = Stage::kVerify;
  Error reason;
};

// What result.json tells of one capture as a whole. Made once a result is to be written: may allocate.
struct LocateReport {
  struct StageTime {
    Stage stage = Stage::kDecode;
    double ms = 0.0;
  };
  struct PartTime {
    std::uint16_t segment = 0;
    double total_ms = 0.0;  // from the range image to the pose
  };
  struct MemoryShare {
    std::string name;
    std::uint64_t bytes = 0;
  };

  std::string capture_id;
  std::string calibration_id;
  std::vector<LocatedPart> parts;  // in pick order
  std::vector<WithheldObject> withheld;
  std::vector<StageTime> stage_times;
  std::vector<PartTime> part_times;
  std::vector<MemoryShare> memory;
};

constexpr const char* stage_name(Stage stage) {
  constexpr std::array names{"capture", "decode", "range", "segment", "primitives", "search", "icp", "verify", "rank"};
  return names[static_cast<std::size_t>(stage)];
}

}  // namespace beltpick
