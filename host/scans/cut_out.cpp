#include "scans/cut_out.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "contract/result_codes.hpp"

namespace beltpick::scans {
namespace {

// Another object of this share of the largest one's pixels may be a second part.
constexpr double kRivalShare = 0.1;
constexpr double kGap_mm = 20.0;
// What lies lower is belt, whatever the segments say.
constexpr double kBeltHeight_mm = 2.0;

// Walks from the largest object over what does not show the belt, and notes the objects it comes by.
class Reach {
 public:
  Reach(const RangeImage& range, const segment::Segmented& objects, double gap_px)
      : range_(range),
        objects_(objects),
        gap_px_(static_cast<int>(gap_px)),
        away_(objects.labels.size(), kFar),
        reached_(objects.segments.size() + 1, false) {}

  void walk_from(std::uint16_t label) {
    reached_[label] = true;
    for (int row = 0; row < objects_.labels.rows; ++row) {
      for (int col = 0; col < objects_.labels.cols; ++col) {
        if (objects_.labels(row, col) == label) visit(row, col, 0);
      }
    }
    while (!queue_.empty()) {
      const auto [row, col] = queue_.front();
      queue_.pop_front();
      const int next = away_[index(row, col)] + 1;
      visit(row - 1, col, next);
      visit(row + 1, col, next);
      visit(row, col - 1, next);
      visit(row, col + 1, next);
    }
  }

  [[nodiscard]] bool reached(std::uint16_t label) const { return reached_[label]; }

 private:
  static constexpr int kFar = 1 << 30;

  [[nodiscard]] std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(objects_.labels.cols) +
           static_cast<std::size_t>(col);
  }

  [[nodiscard]] bool shows_belt(int row, int col) const {
    if (objects_.labels(row, col) != 0 || !range_.valid(row, col)) return false;
    return !objects_.belt || objects_.belt->height_mm(range_.point_mm(row, col).cast<double>()) < kBeltHeight_mm;
  }

  void visit(int row, int col, int away) {
    if (!objects_.labels.contains(row, col) || shows_belt(row, col)) return;
    const std::uint16_t label = objects_.labels(row, col);
    if (label != 0) away = 0;
    if (away > gap_px_ || away >= away_[index(row, col)]) return;
    away_[index(row, col)] = away;
    reached_[label] = true;
    // What is reached without a gap comes first, so that every pixel is seen with its least distance.
    if (away == 0) {
      queue_.push_front({row, col});
    } else {
      queue_.push_back({row, col});
    }
  }

  const RangeImage& range_;
  const segment::Segmented& objects_;
  int gap_px_;
  std::vector<int> away_;
  std::vector<bool> reached_;
  std::deque<std::pair<int, int>> queue_;
};

// How many pixels kGap_mm is across the object.
double gap_px(const RangeImage& range, const segment::Segmented& objects, const Segment& object) {
  for (int row = (object.row_min + object.row_max) / 2; row <= object.row_max; ++row) {
    for (int col = object.col_min; col < object.col_max; ++col) {
      if (objects.labels(row, col) != object.label || objects.labels(row, col + 1) != object.label) continue;
      const float step = range.point_mm(row, col + 1).x() - range.point_mm(row, col).x();
      if (step > 0.0F) return kGap_mm / static_cast<double>(step);
    }
  }
  return kGap_mm;
}

}  // namespace

bool CutOut::holds(std::uint16_t label) const {
  return label != 0 && std::find(labels.begin(), labels.end(), label) != labels.end();
}

Result<CutOut> cut_out_part(const RangeImage& range, const segment::Segmented& objects, const std::string& name) {
  if (objects.segments.empty()) {
    return failure(ResultCode::kNothingFound,
                   "%s: expected the part, found no object above the belt; lay the part into the view", name.c_str());
  }
  const Segment& largest = *std::max_element(objects.segments.begin(), objects.segments.end(),
                                             [](const auto& a, const auto& b) { return a.pixels < b.pixels; });
  CutOut part;
  part.row_min = largest.row_min, part.row_max = largest.row_max;
  part.col_min = largest.col_min, part.col_max = largest.col_max;
  Reach reach(range, objects, gap_px(range, objects, largest));
  reach.walk_from(largest.label);
  for (const Segment& object : objects.segments) {
    const bool piece = reach.reached(object.label);
    if (!piece && object.pixels > kRivalShare * largest.pixels) {
      return failure(ResultCode::kUsage,
                     "%s: expected the part alone, found %zu objects (number %d has %d pixels, number %d %d); take the "
                     "others out of the view; beltpick segment shows them",
                     name.c_str(), objects.segments.size(), largest.label, largest.pixels, object.label, object.pixels);
    }
    if (!piece) {
      ++part.left_aside;
      continue;
    }
    part.labels.push_back(object.label);
    part.row_min = std::min(part.row_min, object.row_min);
    part.row_max = std::max(part.row_max, object.row_max);
    part.col_min = std::min(part.col_min, object.col_min);
    part.col_max = std::max(part.col_max, object.col_max);
    part.pixels += object.pixels;
    part.touches_border |= object.touches_border;
  }
  return part;
}

}  // namespace beltpick::scans
