// FrameProbes: a few lines of every frame of a capture, kept to judge afterwards whether the frames are what the
// sequence says. Internal to decode.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/image.hpp"

namespace beltpick::decode {

// Copies a row of pixels; returns what follows the copy.
std::uint16_t* widen_row(const std::uint8_t* pixels, int count, std::uint16_t* out);
std::uint16_t* widen_row(const std::uint16_t* pixels, int count, std::uint16_t* out);

class FrameProbes {
 public:
  static constexpr int kRowLines = 6;
  static constexpr int kColumnLines = 3;

  FrameProbes() = default;
  FrameProbes(Arena& arena, int rows, int cols, int frames);

  void begin(int rows, int cols) {
    rows_ = rows;
    cols_ = cols;
    for (int line = 0; line < kRowLines; ++line) {
      row_of_line_[static_cast<std::size_t>(line)] = (2 * line + 1) * rows / (2 * kRowLines);
    }
    for (int line = 0; line < kColumnLines; ++line) {
      col_of_line_[static_cast<std::size_t>(line)] = (2 * line + 1) * cols / (2 * kColumnLines);
    }
  }

  // Keeps what of the column lines of frame `index` crosses image row `row`: to be called for every row, while it lies
  // in the cache.
  template <class Pixel>
  void sample_row(int index, int row, const Pixel* pixels) {
    std::uint16_t* down = frame(index) + kRowLines * cols_ + row;
    for (std::size_t line = 0; line < kColumnLines; ++line, down += rows_) *down = pixels[col_of_line_[line]];
  }
  // Keeps the row lines of frame `index`.
  template <class Pixel>
  void sample_lines(int index, ImageView<const Pixel> image) {
    std::uint16_t* out = frame(index);
    for (const int row : row_of_line_) out = widen_row(image.row(row), cols_, out);
  }

  [[nodiscard]] int frames() const { return max_frames_; }
  [[nodiscard]] int count() const { return kRowLines * cols_ + kColumnLines * rows_; }
  // The levels of frame `index`, line after line.
  [[nodiscard]] std::span<const std::uint16_t> levels(int index) const {
    return levels_.subspan(static_cast<std::size_t>(index) * capacity_, static_cast<std::size_t>(count()));
  }
  // The probes before this lie along rows of the image, the others along columns.
  [[nodiscard]] int in_row_lines() const { return kRowLines * cols_; }
  // Probes of the line that probe `i` lies on.
  [[nodiscard]] int line_length(int i) const { return i < in_row_lines() ? cols_ : rows_; }
  // True where probe `i` and probe i + 1 are neighbours in the image.
  [[nodiscard]] bool joined(int i) const {
    const int in_rows = kRowLines * cols_;
    return i < in_rows ? (i + 1) % cols_ != 0 : (i - in_rows + 1) % rows_ != 0;
  }

 private:
  std::uint16_t* frame(int index) { return levels_.data() + static_cast<std::size_t>(index) * capacity_; }

  std::size_t capacity_ = 0;  // probes of one frame
  int max_frames_ = 0;
  std::span<std::uint16_t> levels_;
  int rows_ = 0, cols_ = 0;
  std::array<int, kRowLines> row_of_line_{};
  std::array<int, kColumnLines> col_of_line_{};
};

}  // namespace beltpick::decode
