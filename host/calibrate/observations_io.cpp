#include "calibrate/observations_io.hpp"

#include <algorithm>
#include <set>

#include "calibrate/board_corners.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::calibrate {
namespace {

using contract_io::Json;
using contract_io::JsonDocument;
using contract_io::JsonObject;

constexpr const char* kFormat = "beltpick-calibration-observations";
constexpr int kVersion = 1;
constexpr int kMaxSide = 65535;
constexpr int kLitNumbers = 10, kUnlitNumbers = 3;
constexpr const char* kUnlitReason = "too few pixels round it have a projector coordinate";

Json to_json(const ObservedPose& pose) {
  Json lit = Json::array(), unlit = Json::array();
  for (const ObservedCorner& c : pose.corners) {
    if (!c.has_projector()) {
      unlit.push_back({c.corner, c.camera_px.column_px, c.camera_px.row_px});
      continue;
    }
    const auto& by = c.projector_by_camera;
    lit.push_back({c.corner, c.camera_px.column_px, c.camera_px.row_px, c.projector_px.column_px, c.projector_px.row_px,
                   by(0, 0), by(0, 1), by(1, 0), by(1, 1), c.projector_sigma_px});
  }
  return {{"capture", pose.capture}, {"corners", lit}, {"unlit", unlit}};
}

Board read_board(JsonObject object) {
  Board board;
  board.columns = object.integer("columns", {1, kMaxSide});
  board.rows = object.integer("rows", {1, kMaxSide});
  board.square_mm = object.number("square_mm", {0.0, 1e6, true});
  board.marker_mm = object.number("marker_mm", {0.0, 1e6}, 0.0);
  board.dictionary = object.text("dictionary", "");
  object.finish();
  return board;
}

// The rows of a table of `columns` numbers; nested arrays of any count.
std::vector<std::vector<double>> table(JsonObject& object, const char* member, int columns, std::size_t rows) {
  if (rows == 0) {
    object.ignore(member);
    return {};
  }
  const std::vector<double> flat = object.numbers(member, static_cast<int>(rows), columns);
  std::vector<std::vector<double>> result;
  for (auto at = flat.begin(); at != flat.end(); at += columns) result.emplace_back(at, at + columns);
  return result;
}

// The corner that a row of numbers tells; the first three are the corner and where the camera sees it.
ObservedCorner corner_of(const std::vector<double>& numbers) {
  ObservedCorner corner;
  corner.corner = static_cast<int>(std::clamp(numbers[0], -1.0, 1e6));
  corner.camera_px = {numbers[1], numbers[2]};
  if (numbers.size() < kLitNumbers) {
    corner.no_projector_reason = kUnlitReason;
    return corner;
  }
  corner.projector_px = {numbers[3], numbers[4]};
  corner.projector_by_camera << numbers[5], numbers[6], numbers[7], numbers[8];
  corner.projector_sigma_px = numbers[9];
  return corner;
}

void read_corners(JsonObject& object, const char* member, int columns, std::size_t rows, const Board& board,
                  std::set<int>& known, ObservedPose& pose) {
  for (const auto& numbers : table(object, member, columns, rows)) {
    ObservedCorner corner = corner_of(numbers);
    if (corner.corner < 0 || corner.corner >= board.corners() || !known.insert(corner.corner).second) {
      object.fail(ResultCode::kValueOutOfRange, member, "every corner of the board once at most",
                  "corner " + std::to_string(corner.corner));
      return;
    }
    pose.corners.push_back(std::move(corner));
  }
}

}  // namespace

Result<void> write_observations(const std::filesystem::path& path, const Observations& observations) {
  const Board& board = observations.board;
  Json json = {{"format", kFormat},
               {"version", kVersion},
               {"board", {{"columns", board.columns}, {"rows", board.rows}, {"square_mm", board.square_mm}}},
               {"camera", {{"width", observations.camera_width}, {"height", observations.camera_height}}},
               {"projector",
                {{"width", observations.projector.width},
                 {"height", observations.projector.height},
                 {"layout", observations.projector.layout == ProjectorLayout::kDiamond ? "diamond" : "square"}}}};
  if (board.is_charuco()) {
    json["board"]["marker_mm"] = board.marker_mm;
    json["board"]["dictionary"] = board.dictionary;
  }
  json["poses"] = Json::array();
  for (const ObservedPose& pose : observations.poses) json["poses"].push_back(to_json(pose));
  json["left_out"] = Json::array();
  for (const LeftOut& item : observations.left_out) {
    json["left_out"].push_back({{"capture", item.capture}, {"reason", item.reason}});
  }
  return contract_io::write_file(path, contract_io::json_text(json));
}

Result<Observations> read_observations(const std::filesystem::path& path, contract_io::Warnings& warnings) {
  const auto text = contract_io::read_file(path);
  if (!text) return std::unexpected(text.error());
  JsonDocument document(*text, contract_io::one_line(path.string()), warnings);
  JsonObject root = document.root({kFormat}, kVersion);
  Observations seen;
  seen.board = read_board(root.object("board"));
  JsonObject camera = root.object("camera");
  seen.camera_width = camera.integer("width", {1, kMaxSide});
  seen.camera_height = camera.integer("height", {1, kMaxSide});
  camera.finish();
  JsonObject projector = root.object("projector");
  seen.projector.width = projector.integer("width", {1, kMaxSide});
  seen.projector.height = projector.integer("height", {1, kMaxSide});
  seen.projector.layout = static_cast<ProjectorLayout>(projector.choice("layout", {"square", "diamond"}, 0));
  projector.finish();
  for (JsonObject& object : root.objects("poses")) {
    ObservedPose pose{object.text("capture"), {}};
    std::set<int> known;
    read_corners(object, "corners", kLitNumbers, object.length("corners"), seen.board, known, pose);
    read_corners(object, "unlit", kUnlitNumbers, object.length("unlit"), seen.board, known, pose);
    object.finish();
    seen.poses.push_back(std::move(pose));
  }
  for (JsonObject& object : root.objects("left_out")) {
    seen.left_out.push_back({object.text("capture"), -1, object.text("reason")});
    object.finish();
  }
  root.finish();
  if (document.failed()) return document.error();
  if (auto checked = check_board(seen.board); !checked) {
    return failure(checked.error().code, "%s: %s", contract_io::one_line(path.string()).c_str(),
                   checked.error().detail);
  }
  return seen;
}

}  // namespace beltpick::calibrate
