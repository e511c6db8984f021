#include "simulate_live.hpp"

#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "live_report.hpp"
#include "live_switches.hpp"
#include "options.hpp"
#include "virtual_cell/render/capture_faults.hpp"
#include "virtual_cell/render/scene.hpp"
#include "virtual_cell/world/emulator_files.hpp"
#include "virtual_cell/world/live_world.hpp"
#include "virtual_cell/world/plc_program.hpp"

namespace beltpick::cli {
namespace {

using namespace virtual_cell;

std::atomic<bool> stop_wanted{false};
void want_stop(int) { stop_wanted = true; }

struct HostPort {
  std::string host;
  int port = 0;
};

Result<HostPort> parse_host_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  HostPort parsed;
  if (colon != std::string::npos) {
    parsed.host = text.substr(0, colon);
    const auto [end, error] = std::from_chars(text.data() + colon + 1, text.data() + text.size(), parsed.port);
    if (error == std::errc{} && end == text.data() + text.size() && parsed.port > 0 && parsed.port < 65536 &&
        !parsed.host.empty()) {
      return parsed;
    }
  }
  return failure(ResultCode::kUsage, "--plc: expected HOST:PORT, e.g. 127.0.0.1:1502, found '%s'", text.c_str());
}

Result<FaultPlan> make_plan(const LiveOptions& options, std::uint64_t seed) {
  FaultPlan plan(options.faults, seed);
  for (const std::string& name : options.named_faults) {
    if (auto added = plan.add(name); !added) return std::unexpected(added.error());
  }
  return plan;
}

Result<TriggerBoardChoice> choose_board(const LiveOptions& options) {
  if (options.board == "emulated") {
    std::error_code ignored;
    return find_emulator(std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path(), options.firmware);
  }
  if (options.firmware.empty()) return TriggerBoardChoice{};
  return failure(ResultCode::kUsage, "--firmware: goes with --board emulated only");
}

LiveWorldSettings world_settings(const LiveOptions& options, LiveCell cell) {
  LiveWorldSettings settings;
  settings.rig = cell.rig;
  settings.parts = std::move(cell.parts);
  settings.sequence = std::move(cell.sequence);
  settings.render = cell.render;
  settings.seed = cell.seed;
  settings.camera_address = options.camera;
  settings.camera_serial = options.serial;
  settings.trigger_link = options.trigger;
  settings.speed = options.speed;
  settings.views = SceneMaker(settings.parts, settings.rig).make_belt(cell.count, cell.seed);
  return settings;
}

void photograph(LiveWorld& world, const Rig& rig, const std::string& folder, int view) {
  if (folder.empty()) return;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(rig.camera.width) *
                                   static_cast<std::size_t>(rig.camera.height));
  const ImageView<std::uint8_t> image(pixels.data(), rig.camera.height, rig.camera.width);
  world.photograph(image);
  char name[32];
  std::snprintf(name, sizeof name, "stop_%02d_scene.png", view + 1);
  // A picture that cannot be written must not stop the belt.
  if (auto written = contract_io::write_png(std::filesystem::path(folder) / name, image); !written) {
    std::fprintf(stderr, "beltpick simulate: %s\n", written.error().detail);
  }
}

}  // namespace

void add_live_options(CLI::App& app, LiveOptions& options) {
  app.add_flag("--live", options.live, "run the whole cell in real time for a beltpickd");
  app.add_option("--faults", options.faults, "live: share of the belt's stops that a fault hits (default 0)")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--fault", options.named_faults,
                 "live: NAME or NAME@STOP (from 0): " + fault_names() +
                     "; of a written capture, images counted from 0: " + CaptureFaults::help());
  app.add_option(
         "--switches", options.switches,
         "live: make a FIFO here; a line with the name of a device's fault, or e-stop, breaks it, 'mend' mends all")
      ->type_name("FIFO");
  app.add_option("--plc", options.plc, "live: the appliance's Modbus server (default 127.0.0.1:1502)")
      ->type_name("HOST:PORT");
  app.add_option("--camera-address", options.camera, "live: loopback address of the camera (default 127.0.0.1)");
  app.add_option("--serial", options.serial, "live: serial number of the camera (default BP0001)");
  app.add_option("--trigger", options.trigger, "live: where the trigger board's tty is linked to");
  app.add_option("--firmware", options.firmware, "live: the ELF that the emulated board runs (default: as built)")
      ->type_name("ELF");
  app.add_option("--report", options.report, "live: write the report to this file")->type_name("FILE");
  app.add_option("--pictures", options.pictures, "live: folder for a picture of every stop")->type_name("DIR");
  app.add_option("--wait", options.wait_s, "live: seconds to wait for the appliance (default 60)");
  app.add_option("--linger", options.linger_s, "live: seconds to stay powered after the belt's end, or until SIGTERM");
  app.add_option("--speed", options.speed, "live: of belt and robot, against real ones (default 1)")
      ->check(CLI::Range(0.1, 100.0));
}

Result<void> run_live(const LiveOptions& options, LiveCell cell, Session& session) {
  const auto address = parse_host_port(options.plc);
  if (!address) return std::unexpected(address.error());
  auto plan = make_plan(options, cell.seed);
  if (!plan) return std::unexpected(plan.error());
  auto board = choose_board(options);
  if (!board) return std::unexpected(board.error());
  if (!options.pictures.empty()) {
    if (auto made = contract_io::make_folder(options.pictures); !made) return made;
  }
  std::signal(SIGINT, want_stop);
  std::signal(SIGTERM, want_stop);
  const Rig rig = cell.rig;
  LiveWorldSettings settings = world_settings(options, std::move(cell));
  settings.board = std::move(*board);
  auto world = LiveWorld::start(std::move(settings));
  if (!world) return std::unexpected(world.error());
  std::fprintf(stderr, "virtual cell: camera %s at %s, trigger board at %s\n", options.serial.c_str(),
               options.camera.c_str(), options.trigger.c_str());
  std::unique_ptr<LiveSwitches> switches;
  if (!options.switches.empty()) {
    auto opened = LiveSwitches::open(options.switches, **world);
    if (!opened) return std::unexpected(opened.error());
    switches = std::move(*opened);
  }
  auto link = PlcLink::connect(address->host, address->port, options.wait_s * 1000);
  if (!link) return std::unexpected(link.error());

  PlcProgramOptions program_options;
  program_options.on_view_begin = [&](int view) { photograph(**world, rig, options.pictures, view); };
  program_options.on_view_end = [](const ViewRecord& view) { std::fputs(view_line(view).c_str(), stderr); };
  PlcProgram program(**link, **world, std::move(*plan), program_options, stop_wanted);
  const CellReport report = program.run();
  const contract_io::Json json = report_json(report);
  if (!options.report.empty()) {
    if (auto written = contract_io::write_file(options.report, contract_io::json_text(json)); !written) return written;
  }
  session.answer(json, report_text(report));
  std::fflush(stdout);
  const Stopwatch lingering;
  while (!stop_wanted && lingering.elapsed_ms() < options.linger_s * 1000.0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (report.finished) return {};
  return failure(ResultCode::kServiceUnreachable, "the belt was not finished: %s", report.stopped_by.c_str());
}

}  // namespace beltpick::cli
