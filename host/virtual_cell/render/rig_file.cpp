// Reads a rig's TOML file.
#include <set>
#include <string>

#include <toml++/toml.h>

#include "contract/result_codes.hpp"
#include "virtual_cell/render/rig.hpp"

namespace beltpick::virtual_cell {
namespace {

// Fetches a number into `value`; false when the key is there with another type.
template <class T>
bool fetch(const toml::table& table, const char* key, T& value) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return true;
  if constexpr (std::is_same_v<T, int>) {
    if (!node->is_integer()) return false;
    value = node->value<int>().value_or(0);
  } else {
    if (!node->is_number()) return false;
    value = node->value<double>().value_or(0.0);
  }
  return true;
}

// Name of the first member of the wrong type or of no known name; empty when all is well.
std::string fill(const toml::table& table, RigOptions& o) {
  const auto refuse = [&](const char* key, auto& value) { return !fetch(table, key, value); };
  if (refuse("camera_width", o.camera_width)) return "camera_width: expected an integer";
  if (refuse("camera_height", o.camera_height)) return "camera_height: expected an integer";
  if (refuse("projector_width", o.projector_width)) return "projector_width: expected an integer";
  if (refuse("projector_height", o.projector_height)) return "projector_height: expected an integer";
  if (refuse("camera_distance_mm", o.camera_distance_mm)) return "camera_distance_mm: expected a number";
  if (refuse("projector_distance_mm", o.projector_distance_mm)) return "projector_distance_mm: expected a number";
  if (refuse("angle_deg", o.angle_deg)) return "angle_deg: expected a number";
  if (refuse("field_width_mm", o.field_width_mm)) return "field_width_mm: expected a number";
  if (refuse("camera_tilt_deg", o.camera_tilt_deg)) return "camera_tilt_deg: expected a number";
  if (refuse("distortion", o.distortion)) return "distortion: expected a number";
  if (const toml::node* layout = table.get("layout")) {
    const std::string text = layout->value_or(std::string());
    if (text != "square" && text != "diamond") return "layout: expected \"square\" or \"diamond\"";
    o.layout = text == "diamond" ? ProjectorLayout::kDiamond : ProjectorLayout::kSquare;
  }
  static const std::set<std::string, std::less<>> known{"camera_width",
                                                        "camera_height",
                                                        "projector_width",
                                                        "projector_height",
                                                        "camera_distance_mm",
                                                        "projector_distance_mm",
                                                        "angle_deg",
                                                        "field_width_mm",
                                                        "camera_tilt_deg",
                                                        "distortion",
                                                        "layout"};
  for (const auto& [key, node] : table) {
    if (!known.contains(key.str())) return std::string(key.str()) + ": no such member of a rig";
  }
  return {};
}

}  // namespace

Result<RigOptions> read_rig_options(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    return failure(ResultCode::kFileNotFound, "%s: no such file; give the rig's TOML file", file.c_str());
  try {
    RigOptions options;
    const std::string wrong = fill(toml::parse_file(file.string()), options);
    if (!wrong.empty()) return failure(ResultCode::kFormatInvalid, "%s: %s", file.c_str(), wrong.c_str());
    return options;
  } catch (const toml::parse_error& error) {
    return failure(ResultCode::kFormatInvalid, "%s line %u: %s; correct the TOML", file.c_str(),
                   static_cast<unsigned>(error.source().begin.line), std::string(error.description()).c_str());
  }
}

}  // namespace beltpick::virtual_cell
