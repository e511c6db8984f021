#include "contract_io/calibration_io.hpp"

#include <cmath>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {
namespace {

constexpr const char* kCalibrationFormat = "beltpick-calibration";
constexpr const char* kCellFormat = "beltpick-cell";
constexpr int kVersion = 1;
constexpr double kRotationTolerance = 1e-3;
constexpr int kMaxImageSide = 65535;

bool is_rotation(const Mat3& rotation) {
  const double off = (rotation * rotation.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
  return off < kRotationTolerance && std::abs(rotation.determinant() - 1.0) < 3 * kRotationTolerance;
}

// Rounded figures in a file make a rotation slightly askew: the nearest true one is used.
Mat3 nearest_rotation(const Mat3& rotation) {
  const Eigen::JacobiSVD<Mat3> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Mat3 checked_rotation(JsonObject& object, std::string_view member, const Mat3& rotation, JsonDocument& document) {
  if (document.failed()) return Mat3::Identity();
  if (!is_rotation(rotation)) {
    object.fail(ResultCode::kValueOutOfRange, member, "a rotation (orthonormal within 0.001, determinant +1)",
                "a matrix of determinant " + std::to_string(rotation.determinant()));
    return Mat3::Identity();
  }
  return nearest_rotation(rotation);
}

Mat3 read_mat3(JsonObject& object, std::string_view member) {
  const std::vector<double> values = object.numbers(member, 3, 3);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
}

void check_camera_matrix(JsonObject& object, const Mat3& matrix, JsonDocument& document) {
  if (document.failed()) return;
  const bool shape = matrix(0, 1) == 0 && matrix(1, 0) == 0 && matrix.row(2) == Eigen::RowVector3d(0, 0, 1);
  if (!shape) {
    object.fail(ResultCode::kValueOutOfRange, "matrix", "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]",
                "other values where 0 and 1 belong");
  } else if (matrix(0, 0) <= 0 || matrix(1, 1) <= 0) {
    object.fail(ResultCode::kValueOutOfRange, "matrix", "focal lengths greater than 0",
                std::to_string(matrix(0, 0)) + " and " + std::to_string(matrix(1, 1)));
  }
}

Lens read_lens(JsonObject object, JsonDocument& document) {
  Lens lens;
  lens.width = object.integer("width", {1, kMaxImageSide});
  lens.height = object.integer("height", {1, kMaxImageSide});
  const Mat3 matrix = read_mat3(object, "matrix");
  check_camera_matrix(object, matrix, document);
  lens.fx_px = matrix(0, 0);
  lens.fy_px = matrix(1, 1);
  lens.cx_px = matrix(0, 2);
  lens.cy_px = matrix(1, 2);
  const std::vector<double> distortion = object.numbers("distortion", 0, 5);
  std::copy(distortion.begin(), distortion.end(), lens.distortion.begin());
  object.finish();
  return lens;
}

Pose<frame::Projector, frame::Camera> read_stereo(JsonObject object, JsonDocument& document) {
  Pose<frame::Projector, frame::Camera> pose;
  pose.rotation = checked_rotation(object, "rotation", read_mat3(object, "rotation"), document);
  const std::vector<double> translation_mm = object.numbers("translation", 0, 3);
  pose.translation_mm = {translation_mm[0], translation_mm[1], translation_mm[2]};
  if (!document.failed() && pose.translation_mm.norm() < 1e-6) {
    object.fail(ResultCode::kValueOutOfRange, "translation", "a baseline between camera and projector in mm", "none");
  }
  object.finish();
  return pose;
}

template <class To>
std::optional<Pose<To, frame::Camera>> read_pose(JsonObject& object, std::string_view member, JsonDocument& document) {
  if (!object.has(member)) return std::nullopt;
  const std::vector<double> values = object.numbers(member, 4, 4);
  const Mat4 matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  if (!document.failed() && matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    object.fail(ResultCode::kValueOutOfRange, member, "a last row of 0, 0, 0, 1", "another");
  }
  auto pose = Pose<To, frame::Camera>::from_matrix(matrix);
  pose.rotation = checked_rotation(object, member, pose.rotation, document);
  return pose;
}

Json to_json(const Lens& lens) {
  Mat3 matrix = Mat3::Identity();
  matrix(0, 0) = lens.fx_px;
  matrix(1, 1) = lens.fy_px;
  matrix(0, 2) = lens.cx_px;
  matrix(1, 2) = lens.cy_px;
  return {
      {"width", lens.width}, {"height", lens.height}, {"matrix", json_matrix(matrix)}, {"distortion", lens.distortion}};
}

void put_cell(Json& json, const Cell& cell) {
  json["calibration_id"] = cell.calibration_id;
  if (cell.T_belt_camera) json["belt_from_camera"] = json_matrix(cell.T_belt_camera->matrix());
  if (cell.T_robot_camera) json["robot_from_camera"] = json_matrix(cell.T_robot_camera->matrix());
}

}  // namespace

Result<Calibration> parse_calibration(std::string_view text, const std::string& name, Warnings& warnings) {
  JsonDocument document(text, name, warnings);
  JsonObject root = document.root({kCalibrationFormat}, kVersion);
  Calibration calibration;
  calibration.id = root.text("id", "");
  calibration.camera_serial = root.text("camera_serial", "");
  calibration.projector_serial = root.text("projector_serial", "");
  calibration.camera = read_lens(root.object("camera"), document);
  calibration.projector = read_lens(root.object("projector"), document);
  calibration.T_projector_camera = read_stereo(root.object("projector_from_camera"), document);
  root.ignore("quality");
  root.finish();
  if (document.failed()) return document.error();
  return calibration;
}

Result<Calibration> read_calibration(const std::filesystem::path& path, Warnings& warnings) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  return parse_calibration(*text, one_line(path.string()), warnings);
}

Result<void> write_calibration(const std::filesystem::path& path, const Calibration& calibration,
                               std::string_view quality) {
  Json json = {{"format", kCalibrationFormat}, {"version", kVersion}};
  if (!calibration.id.empty()) json["id"] = calibration.id;
  if (!calibration.camera_serial.empty()) json["camera_serial"] = calibration.camera_serial;
  if (!calibration.projector_serial.empty()) json["projector_serial"] = calibration.projector_serial;
  json["camera"] = to_json(calibration.camera);
  json["projector"] = to_json(calibration.projector);
  const Vec3& t_mm = calibration.T_projector_camera.translation_mm;
  json["projector_from_camera"] = {{"rotation", json_matrix(calibration.T_projector_camera.rotation)},
                                   {"translation", {t_mm.x(), t_mm.y(), t_mm.z()}}};
  if (!quality.empty()) json["quality"] = Json::parse(quality);
  return write_file(path, json_text(json));
}

Result<Cell> parse_cell(std::string_view text, const std::string& name, Warnings& warnings) {
  JsonDocument document(text, name, warnings);
  JsonObject root = document.root({kCellFormat}, kVersion);
  Cell cell;
  cell.calibration_id = root.text("calibration_id", "");
  cell.T_belt_camera = read_pose<frame::Belt>(root, "belt_from_camera", document);
  cell.T_robot_camera = read_pose<frame::Robot>(root, "robot_from_camera", document);
  root.finish();
  if (document.failed()) return document.error();
  return cell;
}

Result<Cell> read_cell(const std::filesystem::path& path, Warnings& warnings) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  return parse_cell(*text, one_line(path.string()), warnings);
}

Result<void> write_cell(const std::filesystem::path& path, const Cell& cell) {
  Json json = {{"format", kCellFormat}, {"version", kVersion}};
  put_cell(json, cell);
  return write_file(path, json_text(json));
}

Result<void> update_cell(const std::filesystem::path& path, const Cell& cell) {
  if (!std::filesystem::exists(path)) return write_cell(path, cell);
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  Warnings unknown_members;  // which stay
  const auto judged = parse_cell(*text, one_line(path.string()), unknown_members);
  if (!judged) return std::unexpected(judged.error());
  Json json = Json::parse(*text);
  put_cell(json, cell);
  return write_file(path, json_text(json));
}

}  // namespace beltpick::contract_io
