// The configuration of beltpickd: every key with its default and its meaning, in one list that reads the file, prints
// the commented default and is the documentation.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/api.hpp"
#include "contract/gripper.hpp"
#include "contract/limits.hpp"

namespace beltpick::app {

// Lines of the PC's GPIO; an empty text is a line that is not wired.
struct LineSettings {
  std::string chip = "gpiochip0";
  std::string belt_stopped, emergency_stop, belt_may_move;
  std::string start, busy, fault;
  std::string camera, projector, strobe;
  int debounce_ms = 10;
  int late_limit_us = 500;
};

struct Settings {
  std::filesystem::path folder = ".";  // of the configuration file: relative paths count from here

  std::string camera_id;
  double readout_us = 12000;
  double overlap_gap_us = 0;
  int camera_buffers = 12;
  bool packet_socket = false;

  std::string trigger_source = "microcontroller";
  std::string trigger_tty = "/dev/ttyACM0";
  double strobe_tolerance_us = 500;
  LineSettings lines;

  std::string projector_kind = "edge";
  std::string projector_device;
  std::string projector_connector;
  int projector_first_image = 0;
  std::string projector_edge = "rising";
  std::string projector_light = "white";
  int projector_latency_us = 35000;

  std::string calibration = "calibration.json";
  std::string cell = "cell.json";
  std::vector<std::string> recipes{"recipe.json"};
  int recipe = 0;
  std::string projector_layout = "square";

  int settle_ms = 200;
  int signals_agree_ms = 500;
  int max_age_ms = 15000;
  int processing_timeout_ms = 20000;
  int max_failed_picks = 3;
  double belt_wander_mm = 1.0;
  int pose_workers = 2;

  std::string plc_address = "0.0.0.0";
  int plc_port = 502;
  int plc_max_clients = 8;
  int plc_timeout_ms = 2000;
  std::string float_order = "high-first";

  std::string state;
  bool service_enabled = true;
  std::string service_address = "127.0.0.1";
  int service_port = kDefaultServicePort;
  int service_connections = 32;
  int service_connections_per_address = 8;
  int service_requests_per_minute = 600;
  int service_request_s = 30;
  int service_idle_s = 10;

  GripperShape gripper;
  // What a cell needs mostly, HDR of three exposures included; each template more takes 26 MB.
  Limits limits{.frames = 48, .decode_bytes = 28, .templates = 2};

  std::string record_folder;
  bool record_pictures = true;
  std::string record_frames = "failed";
  int record_keep = 200;
  std::string summary;
};

// Reads a TOML file. Unknown keys warn. Errors: kFileNotFound, kFileUnreadable, kFormatInvalid, kValueOutOfRange.
Result<Settings> read_settings(const std::filesystem::path& path, std::vector<std::string>& warnings);

// The default configuration as commented TOML: reading it back gives the defaults.
std::string default_settings_text();

// `path` from the configuration's folder; empty stays empty.
std::filesystem::path from_settings(const Settings& settings, const std::string& path);

}  // namespace beltpick::app
