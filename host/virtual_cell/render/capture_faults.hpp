// CaptureFaults: what goes wrong with single images of a written capture, told by words such as "drop:5".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/capture.hpp"

namespace beltpick::virtual_cell {

class CaptureFaults {
 public:
  // Adds a fault; image numbers count from 0:
  //   drop:K        the camera missed frame K: the images from K on are each of the next frame, the last is dark
  //   repeat:K      image K is of the frame before it
  //   swap:A,B      the images A and B are exchanged
  //   black:K       the projector was dark at image K
  //   shift:N[@K]   the images from K on (default all) are N frames late; the projector repeats its sequence
  //   move-mm:D@K   the belt moved by D before image K
  //   creep-mm:D    the belt moves evenly, by D from the first image to the last
  //   lens-cap      no light reaches the camera
  // Errors: kUsage for another word, or one whose numbers are missing or malformed.
  Result<void> add(const std::string& text);

  // Error: kUsage where a fault names an image beyond the sequence's `frames`.
  [[nodiscard]] Result<void> check(int frames) const;

  // What the projector shows while image `image` of `sequence` is taken: dark is a black frame.
  [[nodiscard]] FrameSpec shown(const Sequence& sequence, int image) const;
  // How far the belt has moved from where it stood at first.
  [[nodiscard]] double belt_shift_mm(int image, int frames) const;
  [[nodiscard]] bool capped() const { return capped_; }

  // The words above, for --help.
  static const char* help();

 private:
  struct Shift {
    int by = 0, from = 0;
  };
  struct Move {
    double mm = 0.0;
    int from = 0;
  };
  struct Swap {
    int first = 0, second = 0;
  };

  std::vector<int> dropped_, repeated_, black_;
  std::vector<Swap> swapped_;
  std::vector<Shift> shifted_;
  std::vector<Move> moved_;
  double creep_mm_ = 0.0;
  bool capped_ = false;
};

}  // namespace beltpick::virtual_cell
