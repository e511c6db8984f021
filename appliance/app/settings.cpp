#include "app/settings.hpp"

#include <algorithm>
#include <sstream>

#include "app/line_settings.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/toml_config.hpp"

namespace beltpick::app {

namespace {

struct Choice {
  std::initializer_list<const char*> of;
};

// Every key once: visit(key, value, range or choices, meaning). Keys of one table stand together.
template <class Visitor>
void visit_settings(Settings& s, Visitor& visit) {
  visit.table("camera", "The GigE Vision camera");
  visit.text("camera.id", s.camera_id, "IPv4 address (best) or serial number; empty: the first one found");
  visit.number("camera.readout_us", s.readout_us, 0, 1e6, "it needs after the end of an exposure to read it out");
  visit.number("camera.overlap_gap_us", s.overlap_gap_us, 0, 65535,
               "0: it is triggered when it has read out; else it exposes meanwhile, with this pause between exposures");
  visit.integer("camera.buffers", s.camera_buffers, 2, 64, "frames that may wait between network and decoding");
  visit.flag("camera.packet_socket", s.packet_socket, "use a raw socket: faster, needs CAP_NET_RAW");
  visit.table("trigger", "What drives projector and camera frame by frame");
  visit.choice(
      "trigger.source", s.trigger_source, {{"microcontroller", "lines"}},
      "the trigger box, which also reads the belt-stopped and emergency-stop lines; or [lines] of this PC, whose "
      "timing is looser");
  visit.text("trigger.tty", s.trigger_tty, "the trigger box's serial device");
  visit.number("trigger.strobe_tolerance_us", s.strobe_tolerance_us, 10, 1e5,
               "the camera's strobe may lag its pulse by");
  visit.table("lines",
              "GPIO lines of this PC: \"LINE\", its number or name, or \"CHIP:LINE\", then active-low, pull-up or "
              "pull-down where wanted; empty: not wired. gpioinfo lists the lines");
  visit.text("lines.chip", s.lines.chip, "of lines that name no other: gpiochip0, or its label");
  visit.text("lines.belt_stopped", s.lines.belt_stopped,
             "input, beside the trigger box's: active while the belt stands");
  visit.text("lines.emergency_stop", s.lines.emergency_stop,
             "input, beside the trigger box's: active while pressed, so wire it closed and active-low");
  visit.text("lines.belt_may_move", s.lines.belt_may_move,
             "output: the register's bit; wire it so that its pull without power means no");
  visit.text("lines.start", s.lines.start, "output to the trigger box's START, which falls to start: active-low");
  visit.text("lines.busy", s.lines.busy, "BUSY of the trigger box, an input; with trigger.source lines an output");
  visit.text("lines.fault", s.lines.fault, "FAULT of the trigger box, an input; with trigger.source lines an output");
  visit.text("lines.camera", s.lines.camera, "output, with trigger.source lines: active as long as the exposure");
  visit.text("lines.projector", s.lines.projector, "output, with trigger.source lines: a pulse shows the next pattern");
  visit.text("lines.strobe", s.lines.strobe, "input, with trigger.source lines: active while the camera exposes");
  visit.integer("lines.debounce_ms", s.lines.debounce_ms, 0, 1000,
                "belt_stopped and emergency_stop count as harmless again after so long; as harmful at once");
  visit.integer("lines.late_limit_us", s.lines.late_limit_us, 50, 100'000,
                "with trigger.source lines: an exposure longer by more than this ends the capture");
  visit.table("projector", "The projector");
  visit.choice(
      "projector.kind", s.projector_kind, {{"edge", "lightcrafter4500", "display"}},
      "edge: any that holds the images and advances on an edge; lightcrafter4500: set up over USB, then by edges; "
      "display: at a connector of this PC, which flips the pages");
  visit.text(
      "projector.device", s.projector_device,
      "lightcrafter4500: e.g. /dev/beltpick-projector; display: e.g. /dev/dri/card0; empty: the first one found");
  visit.text("projector.connector", s.projector_connector, "display: e.g. HDMI-A-1; empty: the first with a display");
  visit.integer("projector.first_image", s.projector_first_image, 0, 255,
                "lightcrafter4500: index in its flash of the first image of `beltpick patterns --lcr4500`");
  visit.choice("projector.edge", s.projector_edge, {{"rising", "falling"}},
               "lightcrafter4500: of TRIG_IN_1 that advances");
  visit.choice("projector.light", s.projector_light, {{"white", "red", "green", "blue", "yellow", "magenta", "cyan"}},
               "lightcrafter4500: its light sources");
  visit.integer("projector.latency_us", s.projector_latency_us, 0, 500'000,
                "display: from the start of a page's frame at the connector to its light");
  visit.table("model",
              "What to look for and where; paths count from the folder of this file. With service.state these files "
              "only fill a "
              "store that lacks them; then what is uploaded counts");
  visit.text("model.calibration", s.calibration, "calibration.json of camera and projector");
  visit.text("model.cell", s.cell,
             "cell.json: belt and robot seen from the camera; empty: poses in the camera's frame");
  visit.texts("model.recipes", s.recipes, "recipe files");
  visit.integer("model.recipe", s.recipe, 0, 65535,
                "number of the recipe active at the first start, 0: the first one; with service.state later the one "
                "selected last");
  visit.choice("model.projector_layout", s.projector_layout, {{"square", "diamond"}},
               "the projector's lattice; that of a lightcrafter4500 is always diamond");
  visit.table("cycle", "The cell's cycle");
  visit.integer("cycle.settle_ms", s.settle_ms, 0, 60000, "belt held and robot clear for so long before a capture");
  visit.integer("cycle.signals_agree_ms", s.signals_agree_ms, 0, 60000,
                "belt-stopped line and register may differ for");
  visit.integer("cycle.max_age_ms", s.max_age_ms, 100, 3'600'000, "an offer older than this is revoked");
  visit.integer("cycle.processing_timeout_ms", s.processing_timeout_ms, 100, 600'000, "locating may take so long");
  visit.integer("cycle.max_failed_picks", s.max_failed_picks, 1, 100, "failed picks in a row until a person must look");
  visit.number(
      "cycle.belt_wander_mm", s.belt_wander_mm, 0, 1000,
      "the belt may be measured so far from where the cell file has it, 0: anywhere; else a warning in the log");
  visit.integer("cycle.pose_workers", s.pose_workers, 1, 16, "threads that search poses; results do not depend on it");
  visit.table("plc", "The Modbus TCP server; see `beltpick registers`");
  visit.text("plc.address", s.plc_address, "IPv4 address to listen on");
  visit.integer("plc.port", s.plc_port, 0, 65535, "TCP port; below 1024 needs CAP_NET_BIND_SERVICE");
  visit.integer("plc.max_clients", s.plc_max_clients, 1, 32, "connections at a time");
  visit.integer("plc.timeout_ms", s.plc_timeout_ms, 100, 600'000,
                "a heartbeat that does not change for so long is a fault");
  visit.choice("plc.float_order", s.float_order, {{"high-first", "low-first"}}, "the two registers of a Float32");
  visit.table("service", "What the appliance keeps for the engineer, and its HTTPS API");
  visit.text(
      "service.state", s.state,
      "folder of the store, tokens and certificate; empty: none of them, the files of [model] are used directly");
  visit.flag("service.enabled", s.service_enabled, "serve the HTTPS API, where there is a state folder");
  visit.text("service.address", s.service_address,
             "this machine only, until another of its addresses, or :: for all, stands here");
  visit.integer("service.port", s.service_port, 1, 65535, "TCP port");
  visit.integer("service.connections", s.service_connections, 2, 256, "at once");
  visit.integer("service.connections_per_address", s.service_connections_per_address, 1, 256, "at once, of one client");
  visit.integer("service.requests_per_minute", s.service_requests_per_minute, 10, 10'000'000, "of one client");
  visit.integer("service.request_s", s.service_request_s, 1, 3600, "a request and its answer may take so long");
  visit.integer("service.idle_s", s.service_idle_s, 1, 3600, "a client that sends nothing for so long is cut off");
  visit.table("gripper",
              "The room the gripper takes on its way in: parts without it are not offered; a template may have a "
              "gripper of its own");
  visit.number("gripper.jaw_thickness_mm", s.gripper.jaw_thickness_mm, 0, 1000, "along the closing direction");
  visit.number("gripper.jaw_width_mm", s.gripper.jaw_width_mm, 0, 1000, "across it");
  visit.number("gripper.tip_mm", s.gripper.tip_mm, 0, 1000, "the tips reach beyond the grasp's origin by");
  visit.number("gripper.reach_mm", s.gripper.reach_mm, 0, 10000, "the way in is looked at so far behind the tips");
  visit.number("gripper.jaw_depth_mm", s.gripper.jaw_depth_mm, 0, 10000, "from the palm to the tips");
  visit.number("gripper.palm_length_mm", s.gripper.palm_length_mm, 0, 10000, "along the closing direction; 0: no palm");
  visit.number("gripper.palm_width_mm", s.gripper.palm_width_mm, 0, 10000, "across it");
  visit.table("limits", "What memory is taken for at start, whatever is loaded; reaching one is a named result code");
  visit.integer("limits.image_width", s.limits.image_width, 16, 16384, "pixels of the camera");
  visit.integer("limits.image_height", s.limits.image_height, 16, 16384, "");
  visit.integer("limits.frames", s.limits.frames, 3, 512, "of one sequence");
  visit.integer("limits.decode_bytes", s.limits.decode_bytes, 8, 1024,
                "a pixel, to decode with: 16 for one exposure of fast, standard or robust, 20 for two or for micro, 28 "
                "for three; `beltpick patterns --explain` tells others");
  visit.flag("limits.code_rows", s.limits.code_rows, "room for sequences that code projector rows, too");
  visit.integer("limits.templates", s.limits.templates, 1, 64, "of one recipe");
  visit.integer("limits.template_points", s.limits.template_points, 1000, 65535, "of one template");
  visit.integer(
      "limits.grid_cells", s.limits.grid_cells, 0, 100'000'000,
      "of one template's closest-point grid, 2 bytes each; 0: a k-d tree in its place, exact but several times "
      "slower, with some MB a template beside the budget");
  visit.integer("limits.segments", s.limits.segments, 1, 65535, "objects in one image");
  visit.integer("limits.hypotheses", s.limits.hypotheses, 16, 1'000'000, "of one search");
  visit.integer("limits.object_points", s.limits.object_points, 100, 1'000'000, "sampled from one object");
  visit.integer("limits.parts", s.limits.parts, 1, 256, "located in one image");
  visit.table("record", "What is kept of each capture, to look at or to replay");
  visit.text("record.folder", s.record_folder, "where to; empty: nothing is kept");
  visit.flag("record.pictures", s.record_pictures, "range image, objects in colour, overlay of the found parts");
  visit.choice("record.frames", s.record_frames, {{"none", "failed", "withheld", "all"}},
               "of which captures the camera's frames; withheld: failed ones, and those with an object not offered");
  visit.integer("record.keep", s.record_keep, 1, 1'000'000, "captures; the oldest of this run go first");
  visit.text("record.summary", s.summary, "file for a summary of the run as JSON; empty: none");
}

class Reader {
 public:
  explicit Reader(contract_io::TomlConfig& toml) : toml_(toml) {}
  void table(const char*, const char*) {}
  void text(const char* key, std::string& value, const char*) { value = toml_.text(key, value); }
  void texts(const char* key, std::vector<std::string>& value, const char*) {
    if (toml_.has(key)) value = toml_.texts(key);
  }
  void number(const char* key, double& value, double low, double high, const char*) {
    value = toml_.number(key, value, low, high);
  }
  void integer(const char* key, int& value, int low, int high, const char*) {
    value = toml_.integer(key, value, low, high);
  }
  void flag(const char* key, bool& value, const char*) { value = toml_.flag(key, value); }
  void choice(const char* key, std::string& value, const Choice& choices, const char*) {
    value = toml_.text(key, value);
    if (std::find(choices.of.begin(), choices.of.end(), value) != choices.of.end()) return;
    std::string expected;
    for (const char* choice : choices.of) expected += (expected.empty() ? "" : " or ") + std::string(choice);
    toml_.fail(ResultCode::kValueOutOfRange, key, expected, "\"" + value + "\"");
  }

 private:
  contract_io::TomlConfig& toml_;
};

class Printer {
 public:
  void table(const char* name, const char* meaning) { out_ << "\n# " << meaning << ".\n[" << name << "]\n"; }
  void text(const char* key, const std::string& value, const char* meaning) { line(key, quoted(value), meaning); }
  void texts(const char* key, const std::vector<std::string>& values, const char* meaning) {
    std::string list;
    for (const std::string& value : values) list += (list.empty() ? "" : ", ") + quoted(value);
    line(key, "[" + list + "]", meaning);
  }
  void number(const char* key, double value, double low, double high, const char* meaning) {
    std::ostringstream text;
    text << value;
    line(key, text.str(), meaning, range(low, high));
  }
  void integer(const char* key, int value, int low, int high, const char* meaning) {
    line(key, std::to_string(value), meaning, range(low, high));
  }
  void flag(const char* key, bool value, const char* meaning) { line(key, value ? "true" : "false", meaning); }
  void choice(const char* key, const std::string& value, const Choice& choices, const char* meaning) {
    std::string list;
    for (const char* choice : choices.of) list += (list.empty() ? "" : " or ") + std::string(choice);
    line(key, quoted(value), meaning, list);
  }
  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  static std::string quoted(const std::string& value) { return "\"" + value + "\""; }
  template <class Number>
  static std::string range(Number low, Number high) {
    std::ostringstream text;
    text << low << " to " << high;
    return text.str();
  }
  void line(const char* key, const std::string& value, const std::string& meaning, const std::string& allowed = "") {
    const std::string name = std::string(key).substr(std::string(key).find('.') + 1);
    std::string comment = meaning;
    if (!allowed.empty()) comment += (comment.empty() ? "" : "; ") + allowed;
    std::string assignment = name + " = " + value;
    assignment.resize(std::max<std::size_t>(assignment.size() + 1, 36), ' ');
    out_ << assignment << "# " << comment << "\n";
  }

  std::ostringstream out_;
};

}  // namespace

Result<Settings> read_settings(const std::filesystem::path& path, std::vector<std::string>& warnings) {
  auto toml = contract_io::TomlConfig::read(path);
  if (!toml) return std::unexpected(toml.error());
  Settings settings;
  settings.folder = std::filesystem::absolute(path).parent_path();
  Reader reader(*toml);
  visit_settings(settings, reader);
  if (settings.recipes.empty()) toml->fail(ResultCode::kMemberMissing, "model.recipes", "at least one recipe", "none");
  judge_line_settings(settings, *toml);
  if (const auto finished = toml->finish(warnings); !finished) return std::unexpected(finished.error());
  return settings;
}

std::string default_settings_text() {
  Settings settings;
  Printer printer;
  visit_settings(settings, printer);
  return "# Configuration of beltpickd. Every key may be left out; the values here are the defaults.\n" +
         printer.text();
}

std::filesystem::path from_settings(const Settings& settings, const std::string& path) {
  return path.empty() ? std::filesystem::path() : (settings.folder / path).lexically_normal();
}

}  // namespace beltpick::app
