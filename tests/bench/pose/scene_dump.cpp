#include "bench/pose/scene_dump.hpp"

#include <fstream>

#include "bench/pose/need.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/npy_io.hpp"
#include "contract_io/template_io.hpp"
#include "contract_io/truth_io.hpp"

namespace beltpick::bench {
namespace {

void write_poses(const std::filesystem::path& file, const std::vector<const PartTemplate*>& templates,
                 const pipeline::Located& located) {
  const Eigen::IOFormat rows(17, 0, " ", "\n");
  std::ofstream out(file);
  for (const LocatedPart& part : located.found.parts) {
    out << templates[static_cast<std::size_t>(part.template_index)]->name << " segment " << part.segment << " score "
        << part.score << " coverage " << part.coverage << " rms_mm " << part.rms_mm << "\n"
        << part.T_camera_part.matrix().format(rows) << "\n";
  }
  for (const WithheldObject& object : located.found.withheld) {
    out << "withheld segment " << object.segment << " " << stage_name(object.stage) << " "
        << result_code_name(object.reason.code) << ": " << object.reason.detail << "\n";
  }
}

}  // namespace

void write_scene(const std::filesystem::path& folder, const SeenScene& seen, const Calibration& calibration,
                 const std::vector<const PartTemplate*>& templates, const pipeline::Located& located,
                 const SceneRecord& record) {
  std::filesystem::create_directories(folder);
  const auto& points = seen.range.point_mm;
  need(contract_io::write_npy(folder / "cloud.npy", std::span<const float>(points.data->data(), 3 * points.size()),
                              {points.rows, points.cols, 3}));
  need(contract_io::write_npy(folder / "sigma.npy",
                              std::span<const float>(seen.range.sigma_mm.data, seen.range.sigma_mm.size()),
                              {points.rows, points.cols}));
  const auto write_labels = [&](const std::filesystem::path& file, ImageView<const std::uint16_t> labels) {
    need(contract_io::write_npy(file, std::span<const std::uint16_t>(labels.data, labels.size()),
                                {points.rows, points.cols}));
  };
  write_labels(folder / "labels.npy", located.objects.labels);
  write_labels(folder / seen.truth.instances_file, seen.instances);
  need(contract_io::write_truth(folder / "truth.json", seen.truth));
  need(contract_io::write_calibration(folder / "calibration.json", calibration));
  for (const PartTemplate* part : templates)
    need(contract_io::write_template(folder / (part->name + ".template"), *part));
  write_poses(folder / "poses.txt", templates, located);
  std::ofstream(folder / "fate.json") << to_line(record) << "\n";
}

}  // namespace beltpick::bench
