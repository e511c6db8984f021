// The self-test's checks of camera, network and trigger box.
#include "service/self_test_checks.hpp"

namespace beltpick::service {

namespace {

constexpr const char* kHeld = "the running beltpickd has it: ask that one with 'beltpick doctor --to HOST'";
constexpr int kJumboBytes = 8000;
constexpr double kFramesForComfort = 4.0;  // what may wait while the stream's thread is scheduled late

// What stands in the way of judging one of the camera's settings; nothing where the camera is there.
std::optional<Check> unseen(const char* name, const CameraFound& camera) {
  if (camera.state == DeviceState::kGood) return std::nullopt;
  if (camera.state == DeviceState::kHeldByDaemon) return skipped(name, "%s", kHeld);
  return skipped(name, "the camera is not there to be asked");
}

}  // namespace

Check check_camera(const CameraFound& camera, const CalibrationFound& calibration) {
  constexpr const char* kName = "camera";
  if (camera.state == DeviceState::kHeldByDaemon) return skipped(kName, "%s", kHeld);
  if (camera.state == DeviceState::kFailed) return failed_by(kName, camera.problem);
  const std::string id = camera.configured_id.empty() ? "(the first one found)" : camera.configured_id;
  if (camera.state == DeviceState::kNoAnswerYet) {
    return not_good(Verdict::kFailed, kName, "no end of opening " + id,
                    "the camera answers, but does not take its settings in time",
                    "power it off and on; check the cable and that no other program uses it");
  }
  const std::string found =
      text("%s, serial number %s, answers at %s", camera.model.c_str(), camera.serial.c_str(), camera.address.c_str());
  if (!calibration.camera_serial.empty() && calibration.camera_serial != camera.serial) {
    return not_good(Verdict::kFailed, kName, found, "the calibration was made with camera " + calibration.camera_serial,
                    "connect that camera, or calibrate this one and upload the calibration");
  }
  return good(kName, "%s", found.c_str());
}

Check check_image_size(const CameraFound& camera) {
  constexpr const char* kName = "image size";
  if (auto check = unseen(kName, camera)) return *check;
  return good(kName, "%dx%d of the sensor's %dx%d pixels", camera.wanted_width, camera.wanted_height,
              camera.sensor_width, camera.sensor_height);
}

Check check_exposure(const CameraFound& camera) {
  constexpr const char* kName = "exposure";
  if (auto check = unseen(kName, camera)) return *check;
  if (camera.trigger_width) return good(kName, "ExposureMode TriggerWidth: as long as the trigger box's pulse");
  return not_good(Verdict::kWarning, kName, "ExposureMode Timed: the same time for every frame",
                  "the camera has no ExposureMode TriggerWidth",
                  "recipes with several exposures will not work with it: use one exposure, or another camera");
}

Check check_packet_size(const CameraFound& camera) {
  constexpr const char* kName = "packet size";
  if (auto check = unseen(kName, camera)) return *check;
  if (camera.packet_bytes <= 0 || camera.interface_mtu <= 0) {
    return not_good(Verdict::kWarning, kName, "not known", "camera or network interface does not tell its packet size",
                    "look for lost packets in the log; set the interface's MTU to 9000 if camera and switch take it");
  }
  const std::string found =
      text("%d bytes on %s, which carries %d", camera.packet_bytes, camera.interface.c_str(), camera.interface_mtu);
  if (camera.packet_bytes > camera.interface_mtu) {
    return not_good(Verdict::kFailed, kName, found, "packets larger than the interface's MTU are cut up or lost",
                    text("ip link set %s mtu 9000, also on the switch; or lower the camera's packet size",
                         camera.interface.c_str()));
  }
  if (camera.packet_bytes < kJumboBytes && camera.interface_mtu >= kJumboBytes) {
    return not_good(Verdict::kWarning, kName, found, "small packets, although the interface carries larger ones",
                    "raise GevSCPSPacketSize in the camera's settings, and check the switch: more load than needed");
  }
  return good(kName, "%s", found.c_str());
}

Check check_socket_buffer(const SocketBufferFound& buffer) {
  constexpr const char* kName = "socket buffer";
  const double frames = static_cast<double>(buffer.granted_bytes) / static_cast<double>(buffer.frame_bytes);
  const std::string found = text("%.1f MB, %.1f frames", static_cast<double>(buffer.granted_bytes) / 1e6, frames);
  if (buffer.granted_bytes >= buffer.wanted_bytes || frames >= kFramesForComfort) {
    return good(kName, "%s", found.c_str());
  }
  return not_good(frames < 1.0 ? Verdict::kFailed : Verdict::kWarning, kName, found,
                  "net.core.rmem_max allows no more: packets are lost while this PC is busy",
                  text("sysctl -w net.core.rmem_max=%lld, and the same in /etc/sysctl.d (deploy/install does it)",
                       2 * static_cast<long long>(buffer.wanted_bytes)));
}

Check check_trigger(const TriggerFound& trigger) {
  constexpr const char* kName = "trigger box";
  if (trigger.state == DeviceState::kHeldByDaemon) return skipped(kName, "%s", kHeld);
  if (trigger.state == DeviceState::kFailed) return failed_by(kName, trigger.problem);
  if (trigger.state == DeviceState::kNoAnswerYet) {
    return not_good(Verdict::kFailed, kName, trigger.tty + " is silent",
                    "something is connected there, but it does not answer as the trigger firmware does",
                    "check trigger.tty in the configuration; flash the firmware; unplug the box and plug it in again");
  }
  if (trigger.by_lines) return good(kName, "none: lines of this PC drive camera and projector, with looser timing");
  return good(kName, "%s with firmware %s, protocol %d, on %s", trigger.board.c_str(), trigger.firmware.c_str(),
              trigger.protocol, trigger.tty.c_str());
}

Check check_lines(const TriggerFound& trigger) {
  constexpr const char* kName = "lines";
  if (trigger.state == DeviceState::kHeldByDaemon) return skipped(kName, "%s", kHeld);
  if (trigger.state != DeviceState::kGood) return skipped(kName, "the trigger box is not there to read them");
  if (!trigger.lines_known) {
    return not_good(Verdict::kFailed, kName, "not told", "the trigger box answers without its inputs",
                    "flash the firmware that belongs to this version");
  }
  const char* belt = trigger.belt_stopped ? "belt stopped" : "belt not stopped";
  if (trigger.emergency_stop) {
    return not_good(Verdict::kWarning, kName, text("%s, emergency stop pressed", belt),
                    "the emergency stop is pressed, or its wire is broken or not connected",
                    "release it; if it is, check the wire: the line is safe when it carries current");
  }
  return good(kName, "%s, emergency stop released", belt);
}

Check check_gpio(const GpioFound& gpio) {
  constexpr const char* kName = "GPIO lines";
  if (!gpio.configured) return skipped(kName, "none of this PC's: [lines] in the configuration is empty");
  if (gpio.state == DeviceState::kHeldByDaemon) return skipped(kName, "%s", kHeld);
  if (gpio.state == DeviceState::kFailed) return failed_by(kName, gpio.problem);
  return good(kName, "%s (libgpiod %s)", gpio.lines.c_str(), gpio.library.c_str());
}

Check check_projector(const ProjectorFound& projector) {
  constexpr const char* kName = "projector";
  if (projector.by_edge_only) return good(kName, "advances on an edge; it cannot be asked how it is");
  if (projector.state == DeviceState::kHeldByDaemon) return skipped(kName, "%s", kHeld);
  if (projector.state == DeviceState::kFailed) return failed_by(kName, projector.problem);
  if (!projector.has_sequence) return skipped(kName, "no recipe can be run: there is nothing to show");
  if (projector.state == DeviceState::kNoAnswerYet) {
    return not_good(Verdict::kFailed, kName, "no end of preparing " + projector.name,
                    "the projector is there, but does not take its sequence in time",
                    "switch it off and on; check its cable");
  }
  const std::string firmware = projector.firmware.empty() ? "" : " with firmware " + projector.firmware;
  return good(kName, "%s%s at %s: %s", projector.name.c_str(), firmware.c_str(), projector.device.c_str(),
              projector.details.c_str());
}

}  // namespace beltpick::service
