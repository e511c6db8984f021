// What the self-test's checks are made of.
#include <cstdarg>
#include <cstdio>

#include "contract/result_codes.hpp"
#include "service/self_test_checks.hpp"

namespace beltpick::service {

namespace {

std::string vtext(const char* format, std::va_list arguments) {
  char line[512];
  std::vsnprintf(line, sizeof line, format, arguments);
  return line;
}

}  // namespace

std::string text(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::string line = vtext(format, arguments);
  va_end(arguments);
  return line;
}

Check good(const char* name, const char* found, ...) {
  std::va_list arguments;
  va_start(arguments, found);
  Check check{name, Verdict::kGood, vtext(found, arguments), "", ""};
  va_end(arguments);
  return check;
}

Check skipped(const char* name, const char* found, ...) {
  std::va_list arguments;
  va_start(arguments, found);
  Check check{name, Verdict::kSkipped, vtext(found, arguments), "", ""};
  va_end(arguments);
  return check;
}

Check not_good(Verdict verdict, const char* name, std::string found, std::string cause, std::string remedy) {
  return {name, verdict, std::move(found), std::move(cause), std::move(remedy)};
}

Check failed_by(const char* name, const Error& problem) {
  Check check{name, Verdict::kFailed, std::string(result_code_name(problem.code)), "", ""};
  const std::string detail(problem.text());
  if (const auto remedy = detail.rfind("; "); remedy != std::string::npos) {
    check.cause = detail.substr(0, remedy);
    check.remedy = detail.substr(remedy + 2);
  } else {
    check.cause = detail;
  }
  const ResultCodeEntry* entry = find_result_code(problem.code);
  if (entry == nullptr) return check;
  if (check.cause.empty()) check.cause = entry->cause;
  if (check.remedy.empty()) check.remedy = entry->remedy;
  return check;
}

SelfTestReport judge(const SelfTestFacts& facts) {
  SelfTestReport report;
  report.time_utc = facts.time_utc;
  report.checks = {
      check_camera(facts.camera, facts.calibration),
      check_image_size(facts.camera),
      check_exposure(facts.camera),
      check_packet_size(facts.camera),
      check_socket_buffer(facts.socket_buffer),
      check_trigger(facts.trigger),
      check_lines(facts.trigger),
      check_gpio(facts.gpio),
      check_projector(facts.projector),
      check_plc_port(facts.plc_port),
      check_folder("state folder", facts.state_folder, "none is configured: the files of [model] are used as they are"),
      check_folder("record folder", facts.record_folder, "none is configured: no captures are kept"),
      check_store(facts.store),
      check_calibration(facts.calibration),
      check_models(facts.models),
      check_clock(facts.clock),
      check_memory(facts.memory),
      check_realtime(facts.realtime_allowed),
      check_service(facts.service_port, facts.certificate),
  };
  return report;
}

}  // namespace beltpick::service
