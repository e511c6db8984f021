#include "virtual_cell/render/capture_faults.hpp"

#include <algorithm>
#include <cstdio>

#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

// Reads `text` by a scanf format that ends with %n; whether `wanted` numbers were found and nothing is left over.
template <class... Numbers>
bool scan(const std::string& text, const char* format, Numbers*... numbers) {
  int end = -1;
  return std::sscanf(text.c_str(), format, numbers..., &end) == static_cast<int>(sizeof...(numbers)) &&
         end == static_cast<int>(text.size());
}

FrameSpec dark() {
  FrameSpec frame;
  frame.kind = FrameKind::kBlack;
  return frame;
}

}  // namespace

const char* CaptureFaults::help() {
  return "drop:K, repeat:K, swap:A,B, black:K, shift:N[@K], move-mm:D@K, creep-mm:D, lens-cap";
}

Result<void> CaptureFaults::add(const std::string& text) {
  int first = 0;
  int second = 0;
  double mm = 0.0;
  if (scan(text, "drop:%d%n", &first)) {
    dropped_.push_back(first);
  } else if (scan(text, "repeat:%d%n", &first)) {
    repeated_.push_back(first);
  } else if (scan(text, "black:%d%n", &first)) {
    black_.push_back(first);
  } else if (scan(text, "swap:%d,%d%n", &first, &second)) {
    swapped_.push_back({first, second});
  } else if (scan(text, "shift:%d%n", &first)) {
    shifted_.push_back({first, 0});
  } else if (scan(text, "shift:%d@%d%n", &first, &second)) {
    shifted_.push_back({first, second});
  } else if (scan(text, "move-mm:%lf@%d%n", &mm, &first)) {
    moved_.push_back({mm, first});
  } else if (scan(text, "creep-mm:%lf%n", &mm)) {
    creep_mm_ = mm;
  } else if (text == "lens-cap") {
    capped_ = true;
  } else {
    return failure(ResultCode::kUsage, "--fault: expected one of %s, found '%s'", help(), text.substr(0, 40).c_str());
  }
  return {};
}

Result<void> CaptureFaults::check(int frames) const {
  std::vector<int> named = dropped_;
  named.insert(named.end(), black_.begin(), black_.end());
  for (const Swap& swap : swapped_) named.insert(named.end(), {swap.first, swap.second});
  for (const Shift& shift : shifted_) named.push_back(shift.from);
  for (const Move& move : moved_) named.push_back(move.from);
  // Nothing comes before image 0 that it could repeat.
  for (const int image : repeated_) named.push_back(image == 0 ? -1 : image);
  for (const int image : named) {
    if (image < 0 || image >= frames) {
      return failure(ResultCode::kUsage,
                     "--fault: expected an image of the %d of the sequence, counted from 0, found %d", frames, image);
    }
  }
  return {};
}

FrameSpec CaptureFaults::shown(const Sequence& sequence, int image) const {
  const int frames = static_cast<int>(sequence.frames.size());
  for (const Swap& swap : swapped_) {
    if (image == swap.first || image == swap.second) {
      image = swap.first + swap.second - image;
      break;
    }
  }
  const auto has = [image](const std::vector<int>& images) { return std::ranges::find(images, image) != images.end(); };
  if (has(black_)) return dark();
  int frame = has(repeated_) ? image - 1 : image;
  for (const Shift& shift : shifted_) {
    if (image >= shift.from) frame = (((frame - shift.by) % frames) + frames) % frames;
  }
  frame += static_cast<int>(std::ranges::count_if(dropped_, [image](int missed) { return image >= missed; }));
  return frame < frames ? sequence.frames[static_cast<std::size_t>(frame)] : dark();
}

double CaptureFaults::belt_shift_mm(int image, int frames) const {
  double shift = frames > 1 ? creep_mm_ * image / (frames - 1) : 0.0;
  for (const Move& move : moved_) {
    if (image >= move.from) shift += move.mm;
  }
  return shift;
}

}  // namespace beltpick::virtual_cell
