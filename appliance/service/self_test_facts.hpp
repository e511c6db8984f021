// What a self-test finds, before it is judged. Gathered by the running appliance from what it holds open, or by
// `beltpickd --self-test` from what it opens itself; tests make it up.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.hpp"
#include "service/self_test.hpp"

namespace beltpick::service {

// A device as seen at the end of the time that it was given.
enum class DeviceState : std::uint8_t {
  kGood,
  kFailed,        // `problem` tells why
  kHeldByDaemon,  // the running beltpickd has it: not touched
  kNoAnswerYet,   // still being opened
};

struct CameraFound {
  DeviceState state = DeviceState::kNoAnswerYet;
  Error problem;
  std::string configured_id;  // empty: the first one found
  std::string model, serial, address;
  int sensor_width = 0, sensor_height = 0;
  int wanted_width = 0, wanted_height = 0;
  bool trigger_width = false;
  int packet_bytes = 0;   // IP header included; 0: not known
  std::string interface;  // on the way to the camera; empty: not known
  int interface_mtu = 0;
};

struct SocketBufferFound {
  std::int64_t granted_bytes = 0;  // what the kernel gives a socket of this process
  std::int64_t wanted_bytes = 0;
  std::int64_t frame_bytes = 0;
};

struct TriggerFound {
  DeviceState state = DeviceState::kNoAnswerYet;
  Error problem;
  bool by_lines = false;  // lines of this PC take its place
  std::string tty;
  std::string board, firmware;  // "ATmega2560", "1.0.0"
  int protocol = 0;
  bool lines_known = false;
  bool belt_stopped = false;
  bool emergency_stop = false;
};

// Digital lines of this PC.
struct GpioFound {
  bool configured = false;
  DeviceState state = DeviceState::kNoAnswerYet;
  Error problem;
  std::string library;  // the version of libgpiod
  std::string lines;    // each with its level, in words
};

struct ProjectorFound {
  DeviceState state = DeviceState::kNoAnswerYet;
  Error problem;
  bool by_edge_only = true;  // there is nothing to ask: it is led by the trigger box alone
  bool has_sequence = false;
  std::string name, device, firmware, details;
};

enum class PortState : std::uint8_t {
  kFree,
  kServedHere,      // by this process
  kServedByDaemon,  // by the running beltpickd
  kTaken,           // by something else
  kForbidden,       // below 1024, and this process may not
  kNoSuchAddress,   // none of this machine's
  kNotUsed,
};

struct PortFound {
  PortState state = PortState::kNotUsed;
  std::string address;
  int port = 0;
  std::string problem;     // the system's words
  bool connected = false;  // a client is there; of a port served here
};

struct FolderFound {
  bool configured = false;
  std::string path;
  bool there = false;
  bool writable = false;  // of one that is not there: whether it could be made
  std::string problem;    // the system's words
  std::int64_t free_bytes = 0;
};

struct StoreFound {
  bool configured = false;
  Error problem;  // kOk where it can be read
  int items = 0;
  std::string damaged;                         // the first item whose newest version was damaged, in words; empty: none
  std::optional<double> calibration_age_days;  // since it was stored
};

struct CalibrationFound {
  bool there = false;
  Error problem;  // kOk where it can be used
  std::string id;
  std::string camera_serial;       // of the camera it was made with; empty: not told
  std::optional<double> age_days;  // since it was stored
};

struct ModelsFound {
  Error problem;  // kOk where a cycle could be started
  std::uint16_t recipe = 0;
  std::string recipe_name;
  int templates = 0;
  int frames = 0;
};

struct ClockFound {
  std::int64_t now_s = 0;            // since 1970
  std::int64_t not_before_s = 0;     // when this program was put there: no right clock shows less
  std::optional<bool> synchronised;  // nothing: the system does not tell
};

struct MemoryFound {
  bool locked = false;
  std::int64_t bytes = 0;
};

struct CertificateFound {
  bool expected = false;  // the service is on
  bool there = false;     // made at the first start
  std::optional<double> days_left;
};

struct SelfTestFacts {
  std::string time_utc;
  CameraFound camera;
  SocketBufferFound socket_buffer;
  TriggerFound trigger;
  GpioFound gpio;
  ProjectorFound projector;
  PortFound plc_port, service_port;
  FolderFound state_folder, record_folder;
  StoreFound store;
  CalibrationFound calibration;
  ModelsFound models;
  ClockFound clock;
  MemoryFound memory;
  bool realtime_allowed = false;
  CertificateFound certificate;
};

// The verdicts, one check after the other: camera, image size, exposure, packet size, socket buffer, trigger box,
// lines, GPIO lines, projector, PLC port, state folder, record folder, store, calibration, models, clock, memory lock,
// real-time, service.
SelfTestReport judge(const SelfTestFacts& facts);

}  // namespace beltpick::service
