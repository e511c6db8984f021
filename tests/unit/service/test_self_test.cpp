// The self-test's verdicts over made-up facts: a good cell is good, and each thing that can be wrong is named by its
// own check, with a cause and a remedy.
#include <catch2/catch.hpp>
#include <functional>
#include <string>

#include "contract/result_codes.hpp"
#include "service/self_test_facts.hpp"
#include "service/self_test_text.hpp"

using namespace beltpick;
using namespace beltpick::service;

namespace {

SelfTestFacts good_cell() {
  SelfTestFacts facts;
  facts.time_utc = "2026-01-31T12:34:56Z";
  facts.camera = {.state = DeviceState::kGood,
                  .problem = {},
                  .configured_id = "192.168.1.10",
                  .model = "Eye",
                  .serial = "E-1",
                  .address = "192.168.1.10",
                  .sensor_width = 1280,
                  .sensor_height = 1024,
                  .wanted_width = 1280,
                  .wanted_height = 960,
                  .trigger_width = true,
                  .packet_bytes = 8996,
                  .interface = "eth0",
                  .interface_mtu = 9000};
  facts.socket_buffer = {.granted_bytes = 16 << 20, .wanted_bytes = 16 << 20, .frame_bytes = 1280 * 960};
  facts.trigger = {.state = DeviceState::kGood,
                   .problem = {},
                   .tty = "/dev/beltpick-trigger",
                   .board = "ATmega2560",
                   .firmware = "1.0.0",
                   .protocol = 1,
                   .lines_known = true,
                   .belt_stopped = true,
                   .emergency_stop = false};
  facts.gpio = {true, DeviceState::kGood, {}, "1.6.3", "start: line 4 of gpiochip0, output, inactive"};
  facts.projector = {.state = DeviceState::kGood,
                     .problem = {},
                     .by_edge_only = false,
                     .has_sequence = true,
                     .name = "LightCrafter 4500",
                     .device = "/dev/hidraw0",
                     .firmware = "4.0.0",
                     .details = "12 patterns"};
  facts.plc_port = {PortState::kServedHere, "0.0.0.0", 502, "", true};
  facts.service_port = {PortState::kServedHere, "127.0.0.1", 8443, "", false};
  facts.state_folder = {true, "/var/lib/beltpick", true, true, "", 20'000'000'000};
  facts.record_folder = {true, "/var/lib/beltpick/records", true, true, "", 20'000'000'000};
  facts.store = {true, {}, 4, "", 12.0};
  facts.calibration = {true, {}, "cal-1", "E-1", 12.0};
  facts.models = {{}, 1, "knuckles", 2, 22};
  facts.clock = {1'800'000'000, 1'790'000'000, true};
  facts.memory = {true, 65'000'000};
  facts.realtime_allowed = true;
  facts.certificate = {true, true, 3600.0};
  return facts;
}

Error error(ResultCode code, const char* detail) { return failure(code, "%s", detail).error(); }

const Check& find(const SelfTestReport& report, const std::string& name) {
  for (const Check& check : report.checks) {
    if (check.name == name) return check;
  }
  FAIL("no check '" << name << "'");
  return report.checks.front();
}

struct Fault {
  const char* what;
  std::function<void(SelfTestFacts&)> cause;
  const char* check;
  Verdict verdict;
  const char* said;  // somewhere in found, cause or remedy
};

const Fault kFaults[] = {
    {"camera silent",
     [](SelfTestFacts& f) {
       f.camera.state = DeviceState::kFailed;
       f.camera.problem = error(ResultCode::kCameraNotFound, "camera 192.168.1.10: does not answer; check its cable");
     },
     "camera", Verdict::kFailed, "check its cable"},
    {"camera held by a viewer",
     [](SelfTestFacts& f) {
       f.camera.state = DeviceState::kFailed;
       f.camera.problem.code = ResultCode::kCameraInUse;
     },
     "camera", Verdict::kFailed, "another program controls the camera"},
    {"camera hangs", [](SelfTestFacts& f) { f.camera.state = DeviceState::kNoAnswerYet; }, "camera", Verdict::kFailed,
     "power"},
    {"another camera than calibrated", [](SelfTestFacts& f) { f.calibration.camera_serial = "E-2"; }, "camera",
     Verdict::kFailed, "E-2"},
    {"no TriggerWidth", [](SelfTestFacts& f) { f.camera.trigger_width = false; }, "exposure", Verdict::kWarning,
     "Timed"},
    {"packets too large", [](SelfTestFacts& f) { f.camera.interface_mtu = 1500; }, "packet size", Verdict::kFailed,
     "mtu 9000"},
    {"packets needlessly small", [](SelfTestFacts& f) { f.camera.packet_bytes = 1400; }, "packet size",
     Verdict::kWarning, "1400"},
    {"packet size unknown", [](SelfTestFacts& f) { f.camera.packet_bytes = 0; }, "packet size", Verdict::kWarning,
     "not known"},
    {"socket buffer of Debian's default", [](SelfTestFacts& f) { f.socket_buffer.granted_bytes = 212'992; },
     "socket buffer", Verdict::kFailed, "net.core.rmem_max"},
    {"socket buffer small", [](SelfTestFacts& f) { f.socket_buffer.granted_bytes = 3 << 20; }, "socket buffer",
     Verdict::kWarning, "net.core.rmem_max"},
    {"trigger box missing",
     [](SelfTestFacts& f) {
       f.trigger.state = DeviceState::kFailed;
       f.trigger.problem = error(ResultCode::kTriggerLost, "trigger /dev/x: cannot be opened (No such file)");
     },
     "trigger box", Verdict::kFailed, "check its cable and power"},
    {"trigger box silent", [](SelfTestFacts& f) { f.trigger.state = DeviceState::kNoAnswerYet; }, "trigger box",
     Verdict::kFailed, "flash"},
    {"lines not told", [](SelfTestFacts& f) { f.trigger.lines_known = false; }, "lines", Verdict::kFailed, "firmware"},
    {"emergency stop", [](SelfTestFacts& f) { f.trigger.emergency_stop = true; }, "lines", Verdict::kWarning,
     "emergency stop"},
    {"GPIO line held",
     [](SelfTestFacts& f) {
       f.gpio.state = DeviceState::kFailed;
       f.gpio.problem = error(ResultCode::kLineInUse, "lines.start: held by 'gpiomon'; end that program");
     },
     "GPIO lines", Verdict::kFailed, "end that program"},
    {"projector unplugged",
     [](SelfTestFacts& f) {
       f.projector.state = DeviceState::kFailed;
       f.projector.problem = error(ResultCode::kProjectorLost, "projector: found none; check its USB cable and power");
     },
     "projector", Verdict::kFailed, "check its USB cable"},
    {"projector hangs", [](SelfTestFacts& f) { f.projector.state = DeviceState::kNoAnswerYet; }, "projector",
     Verdict::kFailed, "LightCrafter 4500"},
    {"no PLC", [](SelfTestFacts& f) { f.plc_port.connected = false; }, "PLC port", Verdict::kWarning, "PLC"},
    {"PLC port taken", [](SelfTestFacts& f) { f.plc_port.state = PortState::kTaken; }, "PLC port", Verdict::kFailed,
     ":502"},
    {"PLC port forbidden", [](SelfTestFacts& f) { f.plc_port.state = PortState::kForbidden; }, "PLC port",
     Verdict::kFailed, "CAP_NET_BIND_SERVICE"},
    {"PLC address of nobody", [](SelfTestFacts& f) { f.plc_port.state = PortState::kNoSuchAddress; }, "PLC port",
     Verdict::kFailed, "plc.address"},
    {"service port taken", [](SelfTestFacts& f) { f.service_port.state = PortState::kTaken; }, "service",
     Verdict::kFailed, "service.port"},
    {"disk read-only",
     [](SelfTestFacts& f) {
       f.state_folder.writable = false;
       f.state_folder.problem = "Read-only file system";
     },
     "state folder", Verdict::kFailed, "Read-only file system"},
    {"disk nearly full", [](SelfTestFacts& f) { f.state_folder.free_bytes = 300'000'000; }, "state folder",
     Verdict::kWarning, "full"},
    {"record disk full", [](SelfTestFacts& f) { f.record_folder.free_bytes = 1'000'000; }, "record folder",
     Verdict::kFailed, "full"},
    {"never calibrated", [](SelfTestFacts& f) { f.calibration.there = false; }, "calibration", Verdict::kFailed,
     "upload"},
    {"calibration of another size",
     [](SelfTestFacts& f) { f.calibration.problem.code = ResultCode::kCalibrationMismatch; }, "calibration",
     Verdict::kFailed, "CALIBRATION_MISMATCH"},
    {"calibration old", [](SelfTestFacts& f) { f.calibration.age_days = 91.0; }, "calibration", Verdict::kWarning,
     "91 days"},
    {"newest version damaged", [](SelfTestFacts& f) { f.store.damaged = "cell: version 3 is damaged"; }, "store",
     Verdict::kFailed, "upload it again"},
    {"store unreadable",
     [](SelfTestFacts& f) { f.store.problem = error(ResultCode::kFileUnreadable, "store: no folder; check the path"); },
     "store", Verdict::kFailed, "check the path"},
    {"template missing", [](SelfTestFacts& f) { f.models.problem.code = ResultCode::kNoTemplate; }, "models",
     Verdict::kFailed, "teach"},
    {"clock at 1970", [](SelfTestFacts& f) { f.clock.now_s = 1000; }, "clock", Verdict::kFailed, "timedatectl"},
    {"clock not synchronised", [](SelfTestFacts& f) { f.clock.synchronised = false; }, "clock", Verdict::kWarning,
     "time server"},
    {"memory not locked", [](SelfTestFacts& f) { f.memory.locked = false; }, "memory lock", Verdict::kWarning,
     "LimitMEMLOCK"},
    {"no real-time", [](SelfTestFacts& f) { f.realtime_allowed = false; }, "real-time", Verdict::kWarning,
     "LimitRTPRIO"},
    {"certificate ends soon", [](SelfTestFacts& f) { f.certificate.days_left = 30.0; }, "service", Verdict::kWarning,
     "30 days"},
    {"certificate ended", [](SelfTestFacts& f) { f.certificate.days_left = -1.0; }, "service", Verdict::kFailed,
     "enrol"},
    {"certificate damaged", [](SelfTestFacts& f) { f.certificate.days_left.reset(); }, "service", Verdict::kFailed,
     "tls/"},
};

}  // namespace

TEST_CASE("a good cell is good in every check") {
  const SelfTestReport report = judge(good_cell());
  CHECK(report.worst() == Verdict::kGood);
  CHECK(report.checks.size() == 19);
  for (const Check& check : report.checks) {
    CAPTURE(check.name, check.found);
    CHECK(check.verdict == Verdict::kGood);
    CHECK(!check.found.empty());
    CHECK(check.cause.empty());
    CHECK(check.remedy.empty());
  }
}

TEST_CASE("each fault is named by its own check, with cause and remedy, and by no other") {
  for (const Fault& fault : kFaults) {
    SelfTestFacts facts = good_cell();
    fault.cause(facts);
    const SelfTestReport report = judge(facts);
    const Check& check = find(report, fault.check);
    CAPTURE(fault.what, check.found, check.cause, check.remedy);
    CHECK(check.verdict == fault.verdict);
    CHECK(!check.cause.empty());
    CHECK(!check.remedy.empty());
    CHECK((check.found + check.cause + check.remedy).find(fault.said) != std::string::npos);
    for (const Check& other : report.checks) {
      CAPTURE(other.name, other.found);
      CHECK((other.name == fault.check || other.verdict == Verdict::kGood || other.verdict == Verdict::kSkipped));
    }
  }
}

TEST_CASE("what the running beltpickd holds is skipped, not failed") {
  SelfTestFacts facts = good_cell();
  facts.camera.state = facts.trigger.state = DeviceState::kHeldByDaemon;
  facts.plc_port.state = facts.service_port.state = PortState::kServedByDaemon;
  const SelfTestReport report = judge(facts);
  CHECK(report.worst() == Verdict::kGood);
  CHECK(find(report, "camera").verdict == Verdict::kSkipped);
  CHECK(find(report, "trigger box").verdict == Verdict::kSkipped);
  CHECK(find(report, "PLC port").verdict == Verdict::kGood);
}

TEST_CASE("what is not configured is skipped") {
  SelfTestFacts facts = good_cell();
  facts.state_folder = facts.record_folder = {};
  facts.certificate = {};
  const SelfTestReport report = judge(facts);
  for (const char* name : {"state folder", "record folder", "service"}) {
    CHECK(find(report, name).verdict == Verdict::kSkipped);
  }
}

TEST_CASE("a projector that only advances on an edge is good, one without a recipe is not judged") {
  SelfTestFacts facts = good_cell();
  facts.projector = {};
  CHECK(find(judge(facts), "projector").verdict == Verdict::kGood);
  facts.projector.by_edge_only = false;
  CHECK(find(judge(facts), "projector").verdict == Verdict::kSkipped);
  facts.projector.state = DeviceState::kHeldByDaemon;
  CHECK(find(judge(facts), "projector").verdict == Verdict::kSkipped);
}

TEST_CASE("the report as text names every check that is not good with its remedy, and counts") {
  SelfTestFacts facts = good_cell();
  facts.realtime_allowed = false;
  const std::string table = self_test_table(judge(facts));
  CHECK(table.find("warning   real-time") != std::string::npos);
  CHECK(table.find("remedy: start it as the service") != std::string::npos);
  CHECK(table.ends_with("18 good, 1 warning, 0 failed, 0 skipped\n"));
  const std::string json = self_test_json(judge(facts));
  CHECK(json.find("\"worst\": \"warning\"") != std::string::npos);
}
