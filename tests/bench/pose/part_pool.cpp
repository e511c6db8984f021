#include "bench/pose/part_pool.hpp"

#include <cstdlib>
#include <stdexcept>

#include "bench/pose/need.hpp"
#include "contract_io/template_io.hpp"
#include "virtual_cell/render/target_shapes.hpp"

namespace beltpick::bench {
namespace {

namespace vc = virtual_cell;

// Of the built-in parts those that a mirror changes: the others have a plane of symmetry.
bool chiral(const std::string& name) { return name != "elbow" && name != "balljoint"; }

PartTemplate taught(const vc::ScenePart& part, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (part.name + ".template");
  if (!std::filesystem::exists(file)) {
    need(vc::write_part(part, folder));
    const std::string stem = (folder / part.name).string();
    std::string command =
        std::string(BELTPICK_BIN_DIR) + "/beltpick teach '" + stem + ".stl' --units mm --out '" + file.string() + "'";
    if (!part.grasps.empty()) command += " --grasps '" + stem + ".grasps.toml'";
    if (std::system((command + " >&2").c_str()) != 0) throw std::runtime_error("'" + command + "' failed");
  }
  return need(contract_io::read_template(file));
}

}  // namespace

PartPool make_part_pool(const std::vector<std::string>& families, const std::filesystem::path& folder) {
  PartPool pool;
  for (const std::string& name : families) {
    pool.families.push_back(static_cast<int>(pool.parts.size()));
    pool.parts.push_back(need(vc::builtin_part(name)));
  }
  pool.twin_of.assign(pool.parts.size(), -1);
  for (const int family : pool.families) {
    const vc::ScenePart part = pool.parts[static_cast<std::size_t>(family)];
    if (!chiral(part.name)) continue;
    pool.twin_of[static_cast<std::size_t>(family)] = static_cast<int>(pool.parts.size());
    pool.twin_of.push_back(family);
    pool.parts.push_back(vc::mirrored(part, part.name + "-mirrored"));
  }
  std::filesystem::create_directories(folder);
  for (const vc::ScenePart& part : pool.parts) pool.templates.push_back(taught(part, folder));
  for (auto& thing : {need(vc::builtin_part("vblock")), need(vc::make_block("block", {72.0, 46.0, 31.0})),
                      need(vc::make_ball("ball", 24.0))}) {
    pool.foreign.push_back(static_cast<int>(pool.parts.size()));
    pool.twin_of.push_back(-1);
    pool.parts.push_back(thing);
    pool.parts.back().finish = vc::Finish::kSteel;
  }
  return pool;
}

}  // namespace beltpick::bench
