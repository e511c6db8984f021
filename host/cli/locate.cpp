// beltpick locate: the parts of a capture or a cloud, with their poses and grasps, as result.json.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/pictures.hpp"
#include "contract_io/result_io.hpp"
#include "contract_io/template_io.hpp"
#include "explain/explain.hpp"
#include "options.hpp"
#include "pipeline/pipeline.hpp"
#include "range_input.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct LocateCommand {
  std::string input, calibration, cell, out, overlay, explain;
  std::vector<std::string> templates;
  int workers = 1;
};

Result<std::vector<PartTemplate>> read_templates(const std::vector<std::string>& paths) {
  std::vector<PartTemplate> templates;
  for (const std::string& path : paths) {
    auto part = contract_io::read_template(path);
    if (!part) return std::unexpected(part.error());
    templates.push_back(std::move(*part));
  }
  return templates;
}

// A calibration's cell, or none. A cell tied to another calibration would put the robot elsewhere.
Result<Cell> read_cell_of(const std::string& path, const RangeInput& input, contract_io::Warnings& warnings) {
  if (path.empty()) return Cell{};
  auto cell = contract_io::read_cell(path, warnings);
  if (!cell) return cell;
  if (!input.calibration_id().empty() && cell->calibration_id != input.calibration_id()) {
    return failure(ResultCode::kCalibrationMismatch,
                   "%s: calibration_id: expected '%s', found '%s'; calibrate the cell with this calibration",
                   path.c_str(), input.calibration_id().c_str(), cell->calibration_id.c_str());
  }
  return cell;
}

// The pipeline in memory of the size that it asks for.
struct Machine {
  std::unique_ptr<ArenaBlock> block;
  Arena arena;
  std::unique_ptr<pipeline::Pipeline> pipeline;

  Machine(const Limits& limits, int workers) {
    Arena measuring;
    const pipeline::Pipeline sizes(measuring, limits, workers);
    block = std::make_unique<ArenaBlock>(measuring.used_bytes());
    arena = Arena(block->data(), block->bytes());
    pipeline = std::make_unique<pipeline::Pipeline>(arena, limits, workers);
  }
};

Limits limits_for(const RangeInput& input, std::size_t templates) {
  Limits limits;
  limits.image_width = std::max(limits.image_width, input.range().point_mm.cols);
  limits.image_height = std::max(limits.image_height, input.range().point_mm.rows);
  limits.templates = static_cast<int>(templates);
  return limits;
}

LocateReport report_of(const pipeline::Located& located, const RangeInput& input, const Arena& arena) {
  LocateReport report;
  report.capture_id = input.id();
  report.calibration_id = input.calibration_id();
  report.parts.assign(located.found.parts.begin(), located.found.parts.end());
  report.withheld.assign(located.found.withheld.begin(), located.found.withheld.end());
  report.stage_times = input.stage_times();
  report.stage_times.push_back({Stage::kSegment, located.segment_ms});
  for (std::size_t i = 0; i < located.found.tried.size(); ++i) {
    report.part_times.push_back({located.found.tried[i], located.found.object_ms[i]});
  }
  for (const Arena::Share& share : arena.shares()) report.memory.push_back({share.name, share.bytes});
  return report;
}

Json json_of(const LocateReport& report, const std::vector<PartTemplate>& templates, const Cell& cell) {
  return Json::parse(contract_io::result_text(report, templates, cell));
}

std::string text_of(const LocateReport& report, const std::vector<PartTemplate>& templates) {
  std::string text;
  char line[480];
  for (const LocatedPart& part : report.parts) {
    const Vec3& at = part.T_camera_part.translation_mm;
    const PartTemplate& taught = templates[static_cast<std::size_t>(part.template_index)];
    const char* grasp =
        part.grasp_index < 0 ? "none" : taught.grasps[static_cast<std::size_t>(part.grasp_index)].name.c_str();
    std::snprintf(line, sizeof line,
                  "segment %d: %s at (%.2f, %.2f, %.2f) mm, %s, coverage %.2f, rms %.3f mm, grasp %s\n", part.segment,
                  taught.name.c_str(), at.x(), at.y(), at.z(),
                  part.status == PoseStatus::kVerified ? "verified" : "ambiguous", part.coverage, part.rms_mm, grasp);
    text += line;
  }
  for (const WithheldObject& object : report.withheld) {
    std::snprintf(line, sizeof line, "segment %d: withheld: %s [%s]\n", object.segment, object.reason.detail,
                  std::string(result_code_name(object.reason.code)).c_str());
    text += line;
  }
  return text.empty() ? "nothing found\n" : text;
}

Result<void> write_overlay(const std::string& path, const RangeInput& input, const LocateReport& report,
                           const std::vector<PartTemplate>& templates) {
  if (path.empty()) return {};
  const auto picture = contract_io::overlay_picture(input.picture(), report.parts, templates, input.lens());
  return contract_io::write_png(path, picture.view());
}

Result<void> run(const LocateCommand& command, Session& session) {
  contract_io::Warnings warnings;
  const auto templates = read_templates(command.templates);
  if (!templates) return std::unexpected(templates.error());
  const auto input = RangeInput::read(command.input, command.calibration, warnings, session.json);
  session.warn(warnings);
  if (!input) return std::unexpected(input.error());
  warnings = {};
  const auto cell = read_cell_of(command.cell, **input, warnings);
  session.warn(warnings);
  if (!cell) return std::unexpected(cell.error());

  // Who listens to the search hears one worker only; the result is the same.
  const Limits limits = limits_for(**input, templates->size());
  Machine machine(limits, command.explain.empty() ? command.workers : 1);
  if (auto loaded = machine.pipeline->load(*templates); !loaded) return loaded;
  std::optional<explain::StoryRecorder> recorder;
  if (!command.explain.empty()) machine.pipeline->set_trace(&recorder.emplace(limits));
  const auto located =
      machine.pipeline->locate({(*input)->range(), (*input)->lens(), (*input)->projector_mm(), (*input)->seed()});
  if (!located) return std::unexpected(located.error());

  const LocateReport report = report_of(*located, **input, machine.arena);
  if (recorder) {
    const explain::Explained explained{*located,         *recorder,         machine.pipeline->models(),
                                       *templates,       (*input)->range(), (*input)->picture(),
                                       (*input)->lens(), (*input)->id()};
    if (auto written = explain::write_explanation(command.explain, explained); !written) return written;
  }
  if (auto written = write_overlay(command.overlay, **input, report, *templates); !written) return written;
  if (auto written = contract_io::write_result(command.out, report, *templates, *cell); !written) return written;
  session.answer(json_of(report, *templates, *cell), text_of(report, *templates));
  return {};
}

}  // namespace

Run add_locate(CLI::App& app) {
  const auto command = std::make_shared<LocateCommand>();
  app.add_option("INPUT", command->input, "CAPTURE (folder or .zip) or CLOUD (.npy)")->required();
  app.add_option("--calibration", command->calibration, "of the capture's camera and projector")
      ->type_name("calibration.json");
  app.add_option("--template", command->templates, "a part to look for; repeat for more")
      ->required()
      ->type_name("FILE");
  app.add_option("--out", command->out, "poses, grasps, and what was withheld and why")
      ->required()
      ->type_name("result.json");
  app.add_option("--cell", command->cell, "adds poses in the frames of belt and robot")->type_name("cell.json");
  app.add_option("--overlay", command->overlay, "the found parts drawn over the image")->type_name("overlay.png");
  app.add_option("--explain", command->explain,
                 "folder for a page (index.html) and the numbers (explain.json) that tell, segment by segment, why")
      ->type_name("DIR");
  app.add_option("--workers", command->workers, "threads; the result is the same for any number (default 1)")
      ->check(CLI::Range(1, 16));
  example(
      app,
      "  beltpick locate capture --calibration calibration.json --template knuckle.template --out result.json\n"
      "  beltpick locate cloud.npy --template knuckle.template --out result.json --overlay overlay.png\n"
      "  beltpick locate record/000017 --calibration calibration.json --template knuckle.template --out result.json "
      "--explain why");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
