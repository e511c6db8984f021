#include "contract_io/truth_io.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {
namespace {

Mat4 matrix_of(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
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
  const Json root{{"format", "beltpick-truth"},
                  {"version", 1},
                  {"parts", parts},
                  {"xyz", truth.xyz_file},
                  {"instances", truth.instances_file}};
  return write_file(path, json_text(root));
}

}  // namespace beltpick::contract_io
