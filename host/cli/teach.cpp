// beltpick teach: a part's mesh or scan becomes the template that locate and the appliance look for.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "base/units.hpp"
#include "commands.hpp"
#include "contract/limits.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/grasps_io.hpp"
#include "contract_io/mesh_io.hpp"
#include "contract_io/template_io.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "scan_input.hpp"
#include "teach/rehearsal.hpp"
#include "teach/report.hpp"
#include "teach/teach.hpp"
#include "teach/units.hpp"
#include "twin_check.hpp"

namespace beltpick::cli {
namespace {

constexpr std::array kKinds{"plane", "cylinder", "sphere"};

struct TeachCommand {
  std::vector<std::string> files;
  std::vector<std::string> against;
  std::string calibration;
  std::string units = "mm";
  std::string out;
  std::string grasps;
  std::string report;
  int views = 16;
  int points = static_cast<int>(teach::TeachOptions{}.points);
};

contract_io::Json json_of(const Primitive& primitive) {
  return {{"kind", kKinds[static_cast<std::size_t>(primitive.kind)]},
          {"radius_mm", primitive.radius_mm},
          {"extent_mm", primitive.extent_mm},
          {"concave", primitive.concave},
          {"surface_share", primitive.inlier_share},
          {"point_mm", {primitive.point_mm.x(), primitive.point_mm.y(), primitive.point_mm.z()}},
          {"direction", {primitive.direction.x(), primitive.direction.y(), primitive.direction.z()}}};
}

contract_io::Json json_of(const TaughtCone& cone) {
  return {{"kind", "cone"},
          {"half_angle_rad", cone.half_angle_rad},
          {"concave", cone.concave},
          {"surface_share", cone.surface_share},
          {"apex_mm", {cone.apex_mm.x(), cone.apex_mm.y(), cone.apex_mm.z()}},
          {"direction", {cone.direction.x(), cone.direction.y(), cone.direction.z()}}};
}

contract_io::Json json_of(const RestingPosition& position) {
  return {{"down", {position.down.x(), position.down.y(), position.down.z()}},
          {"height_mm", position.height_mm},
          {"likelihood", position.likelihood}};
}

contract_io::Json json_of(const std::optional<Requirements>& required) {
  if (!required) return nullptr;
  contract_io::Json json = contract_io::Json::object();
  for (const RequirementMember& member : kRequirementMembers) json[member.name] = *required.*member.value;
  return json;
}

// What the simulated views say; null where none were asked for.
contract_io::Json json_of(const std::optional<teach::Rehearsal>& rehearsal) {
  if (!rehearsal) return nullptr;
  return {{"views", rehearsal->views.size()},
          {"found", rehearsal->count(teach::Outcome::kFound)},
          {"ambiguous", rehearsal->count(teach::Outcome::kAmbiguous)},
          {"withheld", rehearsal->count(teach::Outcome::kWithheld)},
          {"wrong", rehearsal->count(teach::Outcome::kWrong)},
          {"cut_wrong", rehearsal->cut_wrong},
          {"noise_mm", rehearsal->noise_mm},
          {"rms_error", rehearsal->rms_error},
          {"worst_error", rehearsal->worst_error},
          {"median_ms", rehearsal->median_ms},
          {"memory_bytes", rehearsal->memory_bytes},
          {"search_steps",
           {{"turn_rad", rehearsal->basin.steps.turn_rad},
            {"shift_mm", rehearsal->basin.steps.shift_mm},
            {"home_share", rehearsal->basin.home_at_steps}}}};
}

contract_io::Json json_of(const teach::Taught& taught, const std::optional<teach::Rehearsal>& rehearsal,
                          const TeachCommand& command) {
  const Vec3 size = taught.part.box_max_mm - taught.part.box_min_mm;
  contract_io::Json primitives = contract_io::Json::array();
  for (const Primitive& primitive : taught.part.primitives) primitives.push_back(json_of(primitive));
  contract_io::Json cones = contract_io::Json::array();
  for (const TaughtCone& cone : taught.part.cones) cones.push_back(json_of(cone));
  contract_io::Json resting = contract_io::Json::array();
  for (const RestingPosition& position : taught.part.resting) resting.push_back(json_of(position));
  return {{"template", command.out},
          {"size_mm", {size.x(), size.y(), size.z()}},
          {"points", taught.part.point_mm.size()},
          {"spacing_mm", taught.part.spacing_mm},
          {"symmetry", taught.part.symmetry.name},
          {"primitives", primitives},
          {"cones", cones},
          {"resting_positions", resting},
          {"rehearsal", json_of(rehearsal)},
          {"requirements", json_of(taught.part.requirements)},
          {"grasps", taught.part.grasps.size()},
          {"warnings", taught.warnings}};
}

std::string text_of(const teach::Rehearsal& rehearsal) {
  std::array<char, 400> line{};
  const auto worst = [&](std::size_t from) {
    return *std::max_element(rehearsal.rms_error.begin() + static_cast<std::ptrdiff_t>(from),
                             rehearsal.rms_error.begin() + static_cast<std::ptrdiff_t>(from) + 3);
  };
  std::snprintf(line.data(), line.size(),
                "  tried on %zu simulated views: %zu found, %zu ambiguous, %zu withheld, %zu wrong; rms %.3f mm and "
                "%.3f degree along the worst axis, %.0f ms a part (median)\n",
                rehearsal.views.size(), rehearsal.count(teach::Outcome::kFound),
                rehearsal.count(teach::Outcome::kAmbiguous), rehearsal.count(teach::Outcome::kWithheld),
                rehearsal.count(teach::Outcome::kWrong), worst(3), deg_from_rad(worst(0)), rehearsal.median_ms);
  return line.data();
}

std::string text_of(const teach::Taught& taught, const std::optional<teach::Rehearsal>& rehearsal,
                    const TeachCommand& command) {
  const Vec3 size = taught.part.box_max_mm - taught.part.box_min_mm;
  std::array<char, 400> line{};
  std::snprintf(line.data(), line.size(),
                "%s: %.1f x %.1f x %.1f mm, %zu points %.2f mm apart, symmetry %s, %zu grasps\n", command.out.c_str(),
                size.x(), size.y(), size.z(), taught.part.point_mm.size(), taught.part.spacing_mm,
                taught.part.symmetry.name.c_str(), taught.part.grasps.size());
  std::string text = line.data();
  for (const Primitive& p : taught.part.primitives) {
    std::snprintf(line.data(), line.size(), "  %s%s", p.concave ? "concave " : "",
                  kKinds[static_cast<std::size_t>(p.kind)]);
    text += line.data();
    if (p.kind != PrimitiveKind::kPlane) std::snprintf(line.data(), line.size(), ", radius %.2f mm", p.radius_mm);
    if (p.kind != PrimitiveKind::kPlane) text += line.data();
    std::snprintf(line.data(), line.size(), ", %.1f %% of the surface\n", 100 * p.inlier_share);
    text += line.data();
  }
  for (const TaughtCone& cone : taught.part.cones) {
    std::snprintf(line.data(), line.size(), "  %scone, %.1f degree from axis to side, %.1f %% of the surface\n",
                  cone.concave ? "concave " : "", deg_from_rad(cone.half_angle_rad), 100 * cone.surface_share);
    text += line.data();
  }
  std::snprintf(line.data(), line.size(), "  %zu resting positions, the likeliest %.0f %%\n",
                taught.part.resting.size(),
                taught.part.resting.empty() ? 0.0 : 100 * taught.part.resting.front().likelihood);
  text += line.data();
  if (rehearsal) text += text_of(*rehearsal);
  return text;
}

Result<std::vector<Grasp>> grasps_of(const TeachCommand& command) {
  if (command.grasps.empty()) return std::vector<Grasp>{};
  return contract_io::read_grasps(command.grasps);
}

// The part's surface as it was modelled, or as its scans give it.
struct Source {
  Mesh mesh;
  std::optional<scans::Stitched> stitched;
};

Result<Source> read_source(const TeachCommand& command, const Session& session) {
  Source source;
  if (!are_scans(command.files)) {
    auto mesh = contract_io::read_mesh(command.files.front(), teach::mm_per_unit(command.units));
    if (!mesh) return std::unexpected(mesh.error());
    source.mesh = std::move(*mesh);
    return source;
  }
  if (command.units != "mm") {
    return failure(ResultCode::kUsage, "--units %s: scans are in mm; scale them, or leave --units off",
                   command.units.c_str());
  }
  auto stitched = stitch_scans(command.files, command.calibration, session);
  if (!stitched) return std::unexpected(stitched.error());
  session.warn(stitched->warnings);
  source.mesh = stitched->surface;
  source.stitched = std::move(*stitched);
  return source;
}

Result<void> run(const TeachCommand& command, Session& session) {
  Progress progress("teach", 4, session.json);
  auto source = read_source(command, session);
  if (!source) return std::unexpected(source.error());
  auto grasps = grasps_of(command);
  if (!grasps) return std::unexpected(grasps.error());
  progress.show(1);
  const teach::TeachOptions options{.points = static_cast<std::size_t>(command.points),
                                    .mm_per_unit = teach::mm_per_unit(command.units)};
  auto taught = teach::teach(source->mesh, std::move(*grasps), options);
  if (!taught) return failure(taught.error().code, "%s: %s", command.files.front().c_str(), taught.error().detail);
  if (!command.grasps.empty()) {
    const auto gripper = contract_io::read_gripper(command.grasps);
    if (!gripper) return std::unexpected(gripper.error());
    taught->part.gripper = *gripper;
  }
  progress.show(2);
  const auto twins = check_twins(taught->part, command.against, session);
  if (!twins) return std::unexpected(twins.error());
  std::optional<teach::Rehearsal> rehearsal;
  if (command.views > 0) {
    auto rehearsed = teach::rehearse(*taught, source->mesh, command.views);
    if (!rehearsed) return std::unexpected(rehearsed.error());
    rehearsal = std::move(*rehearsed);
  }
  progress.show(3);
  if (auto written = contract_io::write_template(command.out, taught->part); !written) return written;
  if (!command.report.empty()) {
    const std::string name = std::filesystem::path(command.out).stem().string();
    if (auto written = teach::write_report(command.report, name, *taught, rehearsal); !written) return written;
  }
  progress.show(4);
  session.warn(taught->warnings);
  contract_io::Json answer = json_of(*taught, rehearsal, command);
  if (source->stitched) answer["stitched"] = scans_json(*source->stitched);
  if (!command.against.empty()) answer["against"] = twins->answer;
  session.answer(answer, text_of(*taught, rehearsal, command) +
                             (source->stitched ? scans_text(*source->stitched) : "") + twins->text);
  return {};
}

}  // namespace

Run add_teach(CLI::App& app) {
  const auto command = std::make_shared<TeachCommand>();
  app.add_option(
         "files", command->files,
         "the part: a mesh (STL, PLY, OBJ), a finished scan (one PLY without faces), or several scans of it from "
         "different sides: captures, organised clouds (.npy), point clouds (.ply, camera frame)")
      ->required()
      ->type_name("FILE...");
  app.add_option("--calibration", command->calibration, "of the captures' camera and projector")
      ->type_name("calibration.json");
  app.add_option("--against", command->against,
                 "templates that will be loaded together with this one: are they told apart, and from which sides not?")
      ->type_name("TEMPLATE...");
  std::vector<std::string> units;
  for (const teach::Unit& unit : teach::kUnits) units.emplace_back(unit.name);
  app.add_option("--units", command->units, "of the file's coordinates (default mm)")->check(CLI::IsMember(units));
  app.add_option("--out", command->out, "the template to write; its stem becomes the part's name")
      ->required()
      ->type_name("FILE");
  app.add_option("--grasps", command->grasps, "grasps.toml; without it grasps are proposed")->type_name("FILE");
  app.add_option("--points", command->points, "points of the template (default 36600)")
      ->check(CLI::Range(500, Limits{}.template_points));
  app.add_option("--views", command->views, "simulated views that the template is tried on (default 16, 0: none)")
      ->check(CLI::Range(0, 1000));
  app.add_option("--report", command->report, "folder for a page with pictures of what was found")->type_name("DIR");
  example(app,
          "  beltpick teach knuckle.stl --units mm --grasps grasps.toml --out knuckle.template --report report\n"
          "  beltpick teach scan0 scan1 scan2 scan3 scan4 scan5 --calibration calibration.json --out part.template");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
