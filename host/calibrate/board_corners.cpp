#include "calibrate/board_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calibrate/corner_fit.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kMinSide = 3, kMaxSide = 100;
constexpr int kSearchSide_px = 2000;  // larger images are searched reduced; the corners are then refined in full size

struct DictionaryName {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME value;
};
constexpr DictionaryName kDictionaries[] = {
    {"DICT_4X4_50", cv::aruco::DICT_4X4_50},
    {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
    {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
    {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
    {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
    {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
    {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
    {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
    {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
    {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
    {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
    {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
    {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
    {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
    {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
    {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
};

std::optional<cv::aruco::PREDEFINED_DICTIONARY_NAME> find_dictionary(const std::string& name) {
  for (const DictionaryName& known : kDictionaries) {
    if (name == known.name) return known.value;
  }
  return std::nullopt;
}

cv::Mat as_mat(ImageView<const float> image) {
  cv::Mat mat(image.rows, image.cols, CV_32F);
  for (int row = 0; row < image.rows; ++row) std::copy_n(image.row(row), image.cols, mat.ptr<float>(row));
  return mat;
}

// 8 bits, stretched so that the darkest and brightest hundredth fill the range: detectors want contrast.
cv::Mat stretched(const cv::Mat& image) {
  std::vector<float> levels(image.begin<float>(), image.end<float>());
  const auto at = [&](double share) {
    const auto place = levels.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(levels.size() - 1));
    std::nth_element(levels.begin(), place, levels.end());
    return static_cast<double>(*place);
  };
  const double low = at(0.01);
  const double scale = 255.0 / std::max(at(0.99) - low, 1.0);
  cv::Mat bytes;
  image.convertTo(bytes, CV_8U, scale, -low * scale);
  return bytes;
}

// Chessboard

bool detect_chessboard(const cv::Mat& bytes, cv::Size size, std::vector<cv::Point2f>& points) {
  const int sector = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY;
  if (cv::findChessboardCornersSB(bytes, size, points, sector)) return true;
  if (cv::findChessboardCorners(bytes, size, points, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return true;
  }
  return cv::findChessboardCornersSB(bytes, size, points, sector | cv::CALIB_CB_EXHAUSTIVE);
}

// Sine of the turn from the first row to the first column: positive where the numbering is right-handed.
bool is_right_handed(const std::vector<cv::Point2f>& points, int columns) {
  const cv::Point2f along = points[static_cast<std::size_t>(columns) - 1] - points.front();
  const cv::Point2f down = points[points.size() - static_cast<std::size_t>(columns)] - points.front();
  return along.cross(down) > 0.0F;
}

void flip_rows(std::vector<cv::Point2f>& points, int columns) {
  const int rows = static_cast<int>(points.size()) / columns;
  for (int row = 0; row < rows / 2; ++row) {
    std::swap_ranges(points.begin() + row * columns, points.begin() + (row + 1) * columns,
                     points.begin() + (rows - 1 - row) * columns);
  }
}

// Mean level of the quarter in the middle of the square that corner (column, row) begins.
double square_level(const cv::Mat& image, const std::vector<cv::Point2f>& points, int columns, int column, int row) {
  const auto at = [&](int c, int r) { return points[static_cast<std::size_t>(r * columns + c)]; };
  double sum = 0.0;
  int count = 0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      const float u = 0.5F + 0.12F * static_cast<float>(i);
      const float v = 0.5F + 0.12F * static_cast<float>(j);
      const cv::Point2f place = (1 - u) * (1 - v) * at(column, row) + u * (1 - v) * at(column + 1, row) +
                                (1 - u) * v * at(column, row + 1) + u * v * at(column + 1, row + 1);
      const cv::Point pixel(static_cast<int>(std::lround(place.x)), static_cast<int>(std::lround(place.y)));
      if (!cv::Rect(0, 0, image.cols, image.rows).contains(pixel)) continue;
      sum += image.at<float>(pixel);
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

// How much darker the squares are in which column + row is even.
double even_darkness(const cv::Mat& image, const std::vector<cv::Point2f>& points, int columns) {
  const int rows = static_cast<int>(points.size()) / columns;
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const auto parity = static_cast<std::size_t>((row + column) % 2);
      sum[parity] += square_level(image, points, columns, column, row);
      ++count[parity];
    }
  }
  return sum[1] / std::max(count[1], 1) - sum[0] / std::max(count[0], 1);
}

void orient(const Board& board, const cv::Mat& image, std::vector<cv::Point2f>& points) {
  if (!is_right_handed(points, board.columns)) flip_rows(points, board.columns);
  const bool turned = is_symmetric(board) ? points[static_cast<std::size_t>(board.columns) - 1].x < points.front().x
                                          : even_darkness(image, points, board.columns) < 0.0;
  if (turned) std::reverse(points.begin(), points.end());
}

std::vector<FoundCorner> find_chessboard(const Board& board, const cv::Mat& image, const cv::Mat& bytes,
                                         double reduction) {
  std::vector<cv::Point2f> points;
  if (!detect_chessboard(bytes, {board.columns, board.rows}, points)) return {};
  for (cv::Point2f& point : points) {
    point = (point + cv::Point2f(0.5F, 0.5F)) * static_cast<float>(reduction) - cv::Point2f(0.5F, 0.5F);
  }
  orient(board, image, points);
  std::vector<FoundCorner> corners;
  for (std::size_t i = 0; i < points.size(); ++i) {
    corners.push_back({static_cast<int>(i), {points[i].x, points[i].y}});
  }
  return corners;
}

// ChArUco

// OpenCV's releases differ in whether the board's y runs up or down: the numbering is turned to be right-handed.
std::vector<FoundCorner> numbered(const Board& board, const std::vector<int>& ids,
                                  const std::vector<cv::Point2f>& points) {
  std::vector<cv::Point2f> plate;
  for (const int id : ids) {
    plate.emplace_back(static_cast<float>(board.column_of(id)), static_cast<float>(board.row_of(id)));
  }
  const cv::Mat homography = cv::findHomography(plate, points);
  if (homography.empty()) return {};
  const bool right_handed = cv::determinant(homography) > 0.0;
  std::vector<FoundCorner> corners;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const int row = right_handed ? board.row_of(ids[i]) : board.rows - 1 - board.row_of(ids[i]);
    corners.push_back({row * board.columns + board.column_of(ids[i]), {points[i].x, points[i].y}});
  }
  std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) { return a.corner < b.corner; });
  return corners;
}

std::vector<FoundCorner> find_charuco(const Board& board, const cv::Mat& bytes) {
  constexpr int kLeast = 6;
  const auto dictionary = cv::aruco::getPredefinedDictionary(*find_dictionary(board.dictionary));
  const auto pattern =
      cv::aruco::CharucoBoard::create(board.columns + 1, board.rows + 1, static_cast<float>(board.square_mm),
                                      static_cast<float>(board.marker_mm), dictionary);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids, ids;
  std::vector<cv::Point2f> points;
  cv::aruco::detectMarkers(bytes, dictionary, markers, marker_ids);
  if (marker_ids.size() < 4) return {};
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, bytes, pattern, points, ids);
  if (ids.size() < kLeast) return {};
  return numbered(board, ids, points);
}

// First where the gradients round the corner are square to the way to it (Foerstner), then by fit_corner, both in the
// averaged image, which is not rounded to 8 bits. The window keeps clear of whatever else is printed.
void refine(const cv::Mat& image, const std::vector<double>& spacing_px, double window_share,
            std::vector<FoundCorner>& corners) {
  const ImageView<const float> view(image.ptr<float>(), image.rows, image.cols);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double radius_px = std::clamp(window_share * spacing_px[i], 2.5, 10.0);
    const int half = static_cast<int>(radius_px);
    std::vector<cv::Point2f> point{
        {static_cast<float>(corners[i].at_px.column_px), static_cast<float>(corners[i].at_px.row_px)}};
    cv::cornerSubPix(image, point, {half, half}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4});
    const PixelPosition rough{point[0].x, point[0].y};
    corners[i].at_px = fit_corner(view, rough, radius_px).value_or(rough);
  }
}

double distance_px(const PixelPosition& a, const PixelPosition& b) {
  return std::hypot(a.column_px - b.column_px, a.row_px - b.row_px);
}

}  // namespace

bool is_symmetric(const Board& board) { return !board.is_charuco() && (board.columns + board.rows) % 2 == 0; }

Result<void> check_board(const Board& board) {
  if (board.columns < kMinSide || board.rows < kMinSide || board.columns > kMaxSide || board.rows > kMaxSide) {
    return failure(ResultCode::kValueOutOfRange,
                   "--board: expected %d to %d inner corners each way, found %dx%d; count the corners where four "
                   "squares meet",
                   kMinSide, kMaxSide, board.columns, board.rows);
  }
  if (!(board.square_mm > 0.0) || !std::isfinite(board.square_mm)) {
    return failure(ResultCode::kValueOutOfRange, "--square-mm: expected more than 0, found %g", board.square_mm);
  }
  if (!board.is_charuco()) return {};
  if (board.marker_mm >= board.square_mm) {
    return failure(ResultCode::kValueOutOfRange, "--marker-mm: expected less than the square's %g mm, found %g",
                   board.square_mm, board.marker_mm);
  }
  const auto dictionary = find_dictionary(board.dictionary);
  if (!dictionary) {
    return failure(ResultCode::kValueOutOfRange,
                   "--dictionary: expected one of OpenCV's such as DICT_4X4_100 or DICT_6X6_250, found '%.60s'",
                   board.dictionary.c_str());
  }
  const int markers = (board.columns + 1) * (board.rows + 1) / 2;
  const int known = cv::aruco::getPredefinedDictionary(*dictionary)->bytesList.rows;
  if (markers > known) {
    return failure(ResultCode::kValueOutOfRange, "--dictionary: %s has %d markers, the board needs %d; give a larger",
                   board.dictionary.c_str(), known, markers);
  }
  return {};
}

std::vector<double> corner_spacing_px(const Board& board, const std::vector<FoundCorner>& corners) {
  std::map<int, PixelPosition> by_number;
  for (const FoundCorner& found : corners) by_number[found.corner] = found.at_px;
  std::vector<double> spacing_px(corners.size(), 0.0);
  double sum = 0.0;
  int known = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int corner = corners[i].corner;
    double nearest = 0.0;
    const auto consider = [&](int other, bool inside) {
      const auto found = by_number.find(other);
      if (!inside || found == by_number.end()) return;
      const double distance = distance_px(found->second, corners[i].at_px);
      if (nearest == 0.0 || distance < nearest) nearest = distance;
    };
    consider(corner - 1, board.column_of(corner) > 0);
    consider(corner + 1, board.column_of(corner) + 1 < board.columns);
    consider(corner - board.columns, true);
    consider(corner + board.columns, true);
    spacing_px[i] = nearest;
    sum += nearest;
    known += nearest > 0.0 ? 1 : 0;
  }
  for (double& spacing : spacing_px) {
    if (spacing == 0.0) spacing = known > 0 ? sum / known : 8.0;
  }
  return spacing_px;
}

Result<std::vector<FoundCorner>> find_board(const Board& board, ImageView<const float> image) {
  if (auto checked = check_board(board); !checked) return std::unexpected(checked.error());
  const cv::Mat full = as_mat(image);
  cv::Mat bytes = stretched(full);
  const double reduction = std::max(1.0, std::max(image.rows, image.cols) / static_cast<double>(kSearchSide_px));
  std::vector<FoundCorner> corners;
  if (board.is_charuco()) {
    corners = find_charuco(board, bytes);
  } else {
    if (reduction > 1.0) cv::resize(bytes, bytes, {}, 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
    corners = find_chessboard(board, full, bytes, reduction);
  }
  if (corners.empty()) {
    return failure(ResultCode::kNothingFound,
                   "no %dx%d %s found; show the whole plate, sharp, evenly lit and with its white border, and check "
                   "--board (inner corners, columns x rows)",
                   board.columns, board.rows, board.is_charuco() ? "ChArUco board" : "chessboard");
  }
  const double window_share = board.is_charuco() ? 0.5 * (1.0 - board.marker_mm / board.square_mm) : 0.4;
  refine(full, corner_spacing_px(board, corners), window_share, corners);
  return corners;
}

}  // namespace beltpick::calibrate
