#include "app/self_test.hpp"

#include <chrono>
#include <ctime>
#include <thread>

#include "app/line_settings.hpp"
#include "app/model_hub.hpp"
#include "app/projector_choice.hpp"
#include "base/clock.hpp"
#include "base/utc.hpp"
#include "capture/receive_buffer.hpp"
#include "contract/registers.hpp"
#include "service/machine_facts.hpp"
#include "service/store_facts.hpp"

namespace beltpick::app {

using service::DeviceState;
using service::PortState;

namespace {

constexpr std::int64_t kCameraPatience_us = 8'000'000;     // a camera found by its serial number, all settings
constexpr std::int64_t kProjectorPatience_us = 8'000'000;  // all patterns drawn, validated
constexpr std::int64_t kTriggerPatience_us = 4'500'000;    // a board that resets when it is opened

service::CameraFound camera_found(const SelfTestOf& of) {
  service::CameraFound found;
  found.configured_id = of.settings.camera_id;
  found.wanted_width = of.settings.limits.image_width;
  found.wanted_height = of.settings.limits.image_height;
  if (of.camera.state() != capture::CameraState::kReady) {
    found.state = of.camera.tried() ? DeviceState::kFailed : DeviceState::kNoAnswerYet;
    found.problem = of.camera.last_error();
    return found;
  }
  const capture::CameraFacts facts = of.camera.facts().value_or(capture::CameraFacts{});
  found.state = DeviceState::kGood;
  found.model = facts.model;
  found.serial = facts.serial;
  found.address = facts.address;
  found.sensor_width = facts.sensor_width;
  found.sensor_height = facts.sensor_height;
  found.trigger_width = facts.trigger_width;
  found.packet_bytes = facts.packet_bytes;
  const service::InterfaceFound interface = service::find_interface(facts.address);
  found.interface = interface.name;
  found.interface_mtu = interface.mtu;
  return found;
}

const char* board_name(protocol::BoardKind board) {
  switch (board) {
    case protocol::BoardKind::kAtmega2560:
      return "ATmega2560";
    case protocol::BoardKind::kAtmega328p:
      return "ATmega328P";
    case protocol::BoardKind::kHost:
      break;
  }
  return "simulated board";
}

service::TriggerFound trigger_found(const SelfTestOf& of) {
  const capture::TriggerSource& trigger = of.wiring.trigger();
  service::TriggerFound found;
  found.tty = of.settings.trigger_tty;
  found.by_lines = triggers_by_lines(of.settings);
  if (!trigger.connected()) {
    found.state = trigger.tried() ? DeviceState::kFailed : DeviceState::kNoAnswerYet;
    found.problem = trigger.last_error();
    return found;
  }
  const protocol::Identity identity = trigger.identity().value_or(protocol::Identity{});
  const capture::TriggerInputs inputs = trigger.inputs();
  found.state = DeviceState::kGood;
  found.board = board_name(identity.board);
  found.firmware = std::to_string(identity.firmware_major) + "." + std::to_string(identity.firmware_minor) + "." +
                   std::to_string(identity.firmware_patch);
  found.protocol = protocol::kVersion;
  found.lines_known = inputs.known;
  found.belt_stopped = inputs.belt_stopped;
  found.emergency_stop = inputs.emergency_stop;
  return found;
}

service::GpioFound gpio_found(const SelfTestOf& of) {
  service::GpioFound found;
  found.configured = of.wiring.has_lines();
  found.state = DeviceState::kGood;
  found.library = capture::gpio_library_version();
  found.lines = of.wiring.lines_text();
  return found;
}

service::ProjectorFound projector_found(const SelfTestOf& of) {
  service::ProjectorFound found;
  const projector::ProjectorFacts facts = of.projector.facts();
  found.by_edge_only = of.settings.projector_kind == kEdgeProjector;
  found.name = facts.name;
  found.device = facts.device;
  found.firmware = facts.firmware;
  found.details = facts.details;
  found.problem = of.projector.last_error();
  found.has_sequence = of.projector.has_plan();
  found.state = !of.projector.tried()                   ? DeviceState::kNoAnswerYet
                : found.problem.code == ResultCode::kOk ? DeviceState::kGood
                                                        : DeviceState::kFailed;
  return found;
}

service::FolderFound folder_found(const Settings& settings, const std::string& path) {
  return path.empty() ? service::FolderFound{} : service::find_folder(from_settings(settings, path));
}

// Days since a file was written.
std::optional<double> age_days(const std::filesystem::path& file) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(file, error);
  if (error) return std::nullopt;
  return std::chrono::duration<double, std::ratio<86400>>(std::filesystem::file_time_type::clock::now() - written)
      .count();
}

service::CalibrationFound calibration_found(const SelfTestOf& of, const ModelHub::InUse& in_use) {
  service::CalibrationFound found;
  const ResultCode code = in_use.calibration_problem.code;
  found.there = code != ResultCode::kNoCalibration && code != ResultCode::kFileNotFound;
  found.problem = in_use.calibration_problem;
  if (code != ResultCode::kOk) return found;
  found.id = in_use.calibration_id;
  found.camera_serial = in_use.calibration_camera;
  if (of.settings.state.empty()) found.age_days = age_days(from_settings(of.settings, of.settings.calibration));
  return found;
}

service::ModelsFound models_found(const ModelHub::InUse& in_use) {
  return {in_use.problem, in_use.recipe, in_use.recipe_name, in_use.templates, in_use.frames};
}

bool serves(const Settings& settings) { return settings.service_enabled && !settings.state.empty(); }

// The running beltpickd's word on a device that it holds: what keeps it from being ready, where it is that device.
void take_word(const service::DaemonWord& word, std::initializer_list<ResultCode> codes, DeviceState& state,
               Error& problem) {
  state = DeviceState::kHeldByDaemon;
  for (const ResultCode code : codes) {
    const auto number = static_cast<std::uint16_t>(code);
    const bool waits = word.state == static_cast<std::uint16_t>(CellState::kStarting) && word.last_code == number;
    if (!waits && word.fault_code != number) continue;
    state = DeviceState::kFailed;
    problem = {};
    problem.code = code;  // cause and remedy are those of the code
  }
}

void wait_for_devices(const capture::Camera& camera, const capture::TriggerSource& trigger,
                      const projector::ProjectorKeeper& projector) {
  const std::int64_t began_us = monotonic_us();
  const auto waits = [&] {
    const std::int64_t waited_us = monotonic_us() - began_us;
    return (!camera.tried() && waited_us < kCameraPatience_us) ||
           (!trigger.tried() && waited_us < kTriggerPatience_us) ||
           (projector.has_plan() && !projector.tried() && waited_us < kProjectorPatience_us);
  };
  while (waits()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

}  // namespace

service::SelfTestFacts gather_facts(const SelfTestOf& of) {
  const Settings& settings = of.settings;
  service::SelfTestFacts facts;
  facts.time_utc = now_utc();
  facts.camera = camera_found(of);
  facts.socket_buffer = service::find_socket_buffer(
      capture::kStreamSocketBytes, std::int64_t{settings.limits.image_width} * settings.limits.image_height);
  facts.trigger = trigger_found(of);
  facts.gpio = gpio_found(of);
  facts.projector = projector_found(of);
  facts.plc_port = of.plc_port;
  facts.service_port = of.service_port;
  facts.state_folder = folder_found(settings, settings.state);
  facts.record_folder = folder_found(settings, settings.record_folder);
  if (!settings.state.empty()) facts.store = service::find_store(from_settings(settings, settings.state));
  const ModelHub::InUse in_use = of.hub.in_use();
  facts.calibration = calibration_found(of, in_use);
  if (facts.store.configured) facts.calibration.age_days = facts.store.calibration_age_days;
  facts.models = models_found(in_use);
  facts.clock = service::find_clock();
  facts.memory = {of.memory_locked, of.memory_bytes};
  facts.realtime_allowed = service::realtime_allowed();
  if (serves(settings)) facts.certificate = service::find_certificate(from_settings(settings, settings.state));
  facts.certificate.expected = serves(settings);
  return facts;
}

service::SelfTestFacts gather_facts_alone(SelfTestOf of, capture::Camera& camera, Wiring& wiring,
                                          projector::ProjectorKeeper& projector) {
  const Settings& settings = of.settings;
  of.plc_port = service::find_port(settings.plc_address, settings.plc_port);
  const auto word = of.plc_port.state == PortState::kFree
                        ? std::nullopt
                        : service::ask_daemon(settings.plc_address, settings.plc_port);
  if (word) of.plc_port.state = PortState::kServedByDaemon;
  if (serves(settings)) {
    of.service_port = service::find_port(settings.service_address, settings.service_port);
    if (word && of.service_port.state == PortState::kTaken) of.service_port.state = PortState::kServedByDaemon;
  }
  if (!word) {
    const auto opened = wiring.open();
    camera.start();
    wiring.start();
    projector.start();
    wait_for_devices(camera, wiring.trigger(), projector);
    service::SelfTestFacts facts = gather_facts(of);
    if (!opened) {
      facts.gpio.state = DeviceState::kFailed;
      facts.gpio.problem = opened.error();
    }
    return facts;
  }
  service::SelfTestFacts facts = gather_facts(of);
  take_word(*word, {ResultCode::kCameraLost, ResultCode::kCameraNotFound, ResultCode::kCameraInUse}, facts.camera.state,
            facts.camera.problem);
  facts.gpio.state = DeviceState::kHeldByDaemon;
  take_word(*word, {ResultCode::kTriggerLost, ResultCode::kLinesLost}, facts.trigger.state, facts.trigger.problem);
  take_word(*word,
            {ResultCode::kProjectorLost, ResultCode::kProjectorSilent, ResultCode::kProjectorRefused,
             ResultCode::kProjectorWrongReply, ResultCode::kProjectorFault},
            facts.projector.state, facts.projector.problem);
  return facts;
}

}  // namespace beltpick::app
