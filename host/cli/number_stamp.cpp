#include "number_stamp.hpp"

#include <array>
#include <string>

namespace beltpick::cli {
namespace {

// Three dots wide, five high; a row is three bits, the topmost row first.
constexpr std::array<std::array<unsigned, 5>, 10> kDigits{{{7, 5, 5, 5, 7},
                                                           {2, 6, 2, 2, 7},
                                                           {7, 1, 7, 4, 7},
                                                           {7, 1, 7, 1, 7},
                                                           {5, 5, 7, 1, 1},
                                                           {7, 4, 7, 1, 7},
                                                           {7, 4, 7, 5, 7},
                                                           {7, 1, 2, 2, 2},
                                                           {7, 5, 7, 5, 7},
                                                           {7, 5, 7, 1, 7}}};
constexpr int kPitch = 4;  // dots from one digit to the next
constexpr int kHeight = 5;

bool dot_set(const std::string& digits, int dot_row, int dot_col) {
  if (dot_row < 0 || dot_row >= kHeight || dot_col < 0 || dot_col % kPitch == kPitch - 1) return false;
  const auto place = static_cast<std::size_t>(dot_col / kPitch);
  if (place >= digits.size()) return false;
  const auto digit = static_cast<std::size_t>(digits[place] - '0');
  return (kDigits[digit][static_cast<std::size_t>(dot_row)] >> (2 - dot_col % kPitch) & 1U) != 0;
}

}  // namespace

void stamp_number(contract_io::Picture& picture, int row, int col, unsigned number, int scale) {
  const std::string digits = std::to_string(number);
  const int width = kPitch * static_cast<int>(digits.size()) - 1;
  const int top = row - scale * kHeight / 2;
  const int left = col - scale * width / 2;
  const auto view = picture.view();
  for (int r = -scale; r < scale * (kHeight + 1); ++r) {
    for (int c = -scale; c < scale * (width + 1); ++c) {
      if (!view.contains(top + r, left + c)) continue;
      const bool set = r >= 0 && c >= 0 && dot_set(digits, r / scale, c / scale);
      view(top + r, left + c) = set ? contract_io::Rgb{255, 255, 255} : contract_io::Rgb{0, 0, 0};
    }
  }
}

}  // namespace beltpick::cli
