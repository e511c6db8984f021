#include "contract_io/truth_io.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {
namespace {

using Kind = TrueTarget::Kind;

Mat4 matrix_of(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
}

template <class Vector>
std::vector<Vector> vectors_of(const std::vector<double>& numbers) {
  constexpr auto kSize = static_cast<std::size_t>(Vector::SizeAtCompileTime);
  std::vector<Vector> vectors;
  for (std::size_t i = 0; i < numbers.size(); i += kSize) vectors.emplace_back(numbers.data() + i);
  return vectors;
}

Vec3 vector_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

template <class Vector>
Json json_vectors(const std::vector<Vector>& vectors) {
  Json rows = Json::array();
  for (const Vector& vector : vectors) rows.push_back(json_matrix(vector.transpose().eval())[0]);
  return rows;
}

TruePlate plate_of(JsonObject read) {
  TruePlate plate;
  plate.columns = read.integer("columns", {1, 200});
  plate.rows = read.integer("rows", {1, 200});
  plate.square_mm = read.number("square_mm");
  plate.charuco = read.choice("print", {"chess", "charuco"}) == 1;
  plate.width_mm = read.number("width_mm");
  plate.height_mm = read.number("height_mm");
  plate.thickness_mm = read.number("thickness_mm");
  plate.bend_mm = read.number("bend_mm");
  plate.T_camera_plate = Pose<frame::Camera, frame::Part>::from_matrix(matrix_of(read.numbers("pose_camera", 4, 4)));
  const int corners = plate.columns * plate.rows;
  plate.corner_plate_mm = vectors_of<Vec3>(read.numbers("corners_plate_mm", corners, 3));
  plate.corner_camera_px = vectors_of<Eigen::Vector2d>(read.numbers("corners_camera_px", corners, 2));
  plate.corner_projector_px = vectors_of<Eigen::Vector2d>(read.numbers("corners_projector_px", corners, 2));
  read.finish();
  return plate;
}

TrueTarget target_of(JsonObject& read) {
  TrueTarget target;
  target.kind = read.choice("kind", {"plane", "sphere"}) == 1 ? Kind::kSphere : Kind::kPlane;
  target.instance = read.integer("instance", {0, 65535});
  if (target.kind == Kind::kSphere) {
    target.point_camera_mm = vector_of(read.numbers("centre_camera_mm", 0, 3));
    target.radius_mm = read.number("radius_mm");
  } else {
    target.point_camera_mm = vector_of(read.numbers("point_camera_mm", 0, 3));
    target.normal_camera = vector_of(read.numbers("normal_camera", 0, 3));
    target.height_mm = read.number("height_mm");
  }
  read.finish();
  return target;
}

Json plate_json(const TruePlate& plate) {
  return {{"columns", plate.columns},
          {"rows", plate.rows},
          {"square_mm", plate.square_mm},
          {"print", plate.charuco ? "charuco" : "chess"},
          {"width_mm", plate.width_mm},
          {"height_mm", plate.height_mm},
          {"thickness_mm", plate.thickness_mm},
          {"bend_mm", plate.bend_mm},
          {"pose_camera", json_matrix(plate.T_camera_plate.matrix())},
          {"corners_plate_mm", json_vectors(plate.corner_plate_mm)},
          {"corners_camera_px", json_vectors(plate.corner_camera_px)},
          {"corners_projector_px", json_vectors(plate.corner_projector_px)}};
}

Json target_json(const TrueTarget& target) {
  const auto vector = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  if (target.kind == Kind::kSphere) {
    return {{"kind", "sphere"},
            {"instance", target.instance},
            {"centre_camera_mm", vector(target.point_camera_mm)},
            {"radius_mm", target.radius_mm}};
  }
  return {{"kind", "plane"},
          {"instance", target.instance},
          {"point_camera_mm", vector(target.point_camera_mm)},
          {"normal_camera", vector(target.normal_camera)},
          {"height_mm", target.height_mm}};
}

}  // namespace

Result<Truth> parse_truth(std::string_view text, const std::string& name, Warnings& warnings) {
  JsonDocument document(text, name, warnings);
  JsonObject root = document.root({"beltpick-truth"}, 1);
  Truth truth;
  truth.xyz_file = root.text("xyz", truth.xyz_file);
  truth.instances_file = root.text("instances", truth.instances_file);
  for (JsonObject& part : root.objects("parts")) {
    TruePart& read = truth.parts.emplace_back();
    read.part = part.text("part");
    read.T_camera_part = Pose<frame::Camera, frame::Part>::from_matrix(matrix_of(part.numbers("pose_camera", 4, 4)));
    read.visible_fraction = part.number("visible_fraction", {0.0, 1.0});
    for (const std::vector<double>& symmetry : part.matrices("symmetries", 4, 4)) {
      read.symmetries.push_back(Pose<frame::Part, frame::Part>::from_matrix(matrix_of(symmetry)));
    }
    part.finish();
  }
  if (root.has("plate")) truth.plate = plate_of(root.object("plate"));
  if (root.has("targets")) {
    for (JsonObject& target : root.objects("targets")) truth.targets.push_back(target_of(target));
  }
  root.finish();
  if (document.failed()) return document.error();
  return truth;
}

Result<Truth> read_truth(const std::filesystem::path& path, Warnings& warnings) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  return parse_truth(*text, path.string(), warnings);
}

Result<void> write_truth(const std::filesystem::path& path, const Truth& truth) {
  Json parts = Json::array();
  for (const TruePart& part : truth.parts) {
    Json symmetries = Json::array();
    for (const auto& symmetry : part.symmetries) symmetries.push_back(json_matrix(symmetry.matrix()));
    parts.push_back({{"part", part.part},
                     {"pose_camera", json_matrix(part.T_camera_part.matrix())},
                     {"visible_fraction", part.visible_fraction},
                     {"symmetries", symmetries}});
  }
  Json root{{"format", "beltpick-truth"},
            {"version", 1},
            {"parts", parts},
            {"xyz", truth.xyz_file},
            {"instances", truth.instances_file}};
  if (truth.plate) root["plate"] = plate_json(*truth.plate);
  for (const TrueTarget& target : truth.targets) root["targets"].push_back(target_json(target));
  return write_file(path, json_text(root));
}

}  // namespace beltpick::contract_io
