// What was projected, frame by frame, and the capture that holds the images of it (capture.json, sequence.json).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace beltpick {

enum class FrameKind : std::uint8_t { kPhase, kGray, kWhite, kBlack };
enum class Axis : std::uint8_t { kColumn, kRow };
enum class ProjectorLayout : std::uint8_t { kSquare, kDiamond };

struct ProjectorGrid {
  int width = 0;
  int height = 0;
  ProjectorLayout layout = ProjectorLayout::kSquare;

  [[nodiscard]] int extent(Axis axis) const { return axis == Axis::kColumn ? width : height; }
};

// One projected frame. x is the integer pixel index along `axis`.
//   phase: intensity = a + b cos(2 pi x / period_px + offset_rad + 2 pi step / steps)
//   gray:  bit `bit` (0 = least significant) of c xor (c >> 1), c = floor((x + 0.5) / cell_px); bright = 1 unless
//   inverted
struct FrameSpec {
  std::string file;
  FrameKind kind = FrameKind::kWhite;
  Axis axis = Axis::kColumn;
  double period_px = 0.0;
  int steps = 0;
  int step = 0;
  double offset_rad = 0.0;
  double cell_px = 0.0;
  int bit = 0;
  bool inverted = false;
  double exposure_us = 0.0;  // 0 where not told
};

// Where a frame lies among the 24-bit images in a projector's flash (contract/flash_plan.hpp): bit planes first_plane
// .. first_plane + bits - 1 of an image, the least significant first.
struct FlashPlace {
  int image = 0;
  int first_plane = 0;
  int bits = 1;

  bool operator==(const FlashPlace&) const = default;
};

struct Sequence {
  ProjectorGrid projector;
  std::vector<FrameSpec> frames;  // in projection order
  std::vector<FlashPlace> flash;  // of every frame, where the sequence tells it; else empty
};

// capture.json without its images.
struct CaptureHeader {
  Sequence sequence;
  int full_scale = 255;  // the grey level at which the camera saturates
  std::string id;        // from the file where it has one, else the folder's name
};

}  // namespace beltpick
