#include "doctor_checks.hpp"

#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>

#include "appliance_call.hpp"
#include "contract/result_codes.hpp"
#include "link/reach.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

constexpr double kClockWarning_s = 5.0;
constexpr double kClockFailure_s = 300.0;

DoctorCheck here(const char* name, const char* verdict, std::string found, std::string cause = {},
                 std::string remedy = {}) {
  return {"here", name, verdict, std::move(found), std::move(cause), std::move(remedy)};
}

// Seconds since the epoch of an ISO 8601 time in UTC.
std::optional<double> seconds_of(const std::string& text) {
  std::tm utc{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
  if (rest == nullptr) return std::nullopt;
  return static_cast<double>(timegm(&utc));
}

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

DoctorCheck check_name(const link::Address& address) {
  const auto found = link::resolve(address);
  if (!found) {
    return here("name", "failed", found.error().detail, "no name service knows this host",
                "check the name, or give the address");
  }
  std::string addresses;
  for (const std::string& one : *found) addresses += (addresses.empty() ? "" : ", ") + one;
  return here("name", "good", address.host + " is " + addresses);
}

DoctorCheck open_port(const link::Address& address) {
  return here("port", "good", "port " + std::to_string(address.port) + " is open");
}

// Why nothing could be asked: the port is closed, or something else has it.
void add_silence(const link::Address& address, const Error& error, std::vector<DoctorCheck>& checks) {
  if (const auto knocked = link::knock(address); !knocked) {
    checks.push_back(here("port", "failed", knocked.error().detail,
                          "the appliance is off, beltpickd does not run, it listens on its loopback only, or a "
                          "firewall is between",
                          "see 'systemctl status beltpickd' there and [service] address and port in its "
                          "configuration"));
    return;
  }
  checks.push_back(open_port(address));
  checks.push_back(here("service", "failed", error.detail, "something else has this port",
                        "check the port: [service] port in the appliance's configuration"));
}

DoctorCheck check_certificate(const link::FirstContact& contact, const Result<link::KnownAppliance>& known) {
  const std::string shown = contact.fingerprint.text();
  if (!known) return here("certificate", "skipped", "shows " + shown + "; none is known here");
  if (known->fingerprint == contact.fingerprint) return here("certificate", "good", "is the pinned one, " + shown);
  return here("certificate", "failed", "shows " + shown + ", pinned is " + known->fingerprint.text(),
              "the appliance was installed anew, or something else answers in its place",
              "compare it with the one in the appliance's log, then 'beltpick enrol' anew");
}

DoctorCheck check_clock(const Json& health) {
  const auto there = seconds_of(words_at(health, "/time"));
  if (!there) return here("clock", "skipped", "the appliance does not tell its time");
  const double apart = *there + 0.5 - now_s();  // it tells whole seconds
  const double size = std::abs(apart);
  const std::string found = "the appliance's is " + std::to_string(std::lround(size)) + " s " +
                            (apart < 0 ? "behind" : "ahead of") + " this one";
  if (size <= kClockWarning_s) return here("clock", "good", found);
  return here("clock", size > kClockFailure_s ? "failed" : "warning", found, "one of the two is not set by NTP",
              "see 'timedatectl' on both");
}

DoctorCheck check_versions(const Json& health) {
  const std::string there = words_at(health, "/version");
  if (there == BELTPICK_VERSION) return here("versions", "good", "both are " + there);
  return here("versions", "warning", "beltpick is " BELTPICK_VERSION ", beltpickd is " + there,
              "they were installed at different times", "install the same version on both");
}

DoctorCheck check_token(const Result<Json>& status, const link::KnownAppliance& known) {
  if (status) return here("token", "good", "is taken; its role is " + words_at(*status, "/role"));
  return here("token", "failed", status.error().detail, "it was revoked, or the appliance was installed anew",
              "'beltpick enrol --to " + known.address.text() + "' anew");
}

// What the appliance found of itself: a new run where the role allows it, else the last one.
void add_self_test(link::Appliance& appliance, std::vector<DoctorCheck>& checks, const link::Progress& meanwhile) {
  auto report = ask(appliance, ApiAction::kRunSelfTest, {}, {}, meanwhile);
  if (!report && report.error().code == ResultCode::kRoleTooLow) {
    checks.push_back(here("self-test", "skipped", "this is the last one: running it takes an operator's token"));
    report = ask(appliance, ApiAction::kSelfTest);
  }
  if (!report) {
    checks.push_back(here("self-test", "failed", report.error().detail,
                          "the appliance did not answer with its self-test", "see its log: 'journalctl -u beltpickd'"));
    return;
  }
  for (const Json& check : list_at(*report, "/checks")) {
    checks.push_back({"appliance", words_at(check, "/name"), words_at(check, "/verdict"), words_at(check, "/found"),
                      words_at(check, "/cause"), words_at(check, "/remedy")});
  }
}

// Adds the check and tells whether what builds on it can go on.
bool passed(std::vector<DoctorCheck>& checks, DoctorCheck check) {
  const bool good = check.verdict != "failed";
  checks.push_back(std::move(check));
  return good;
}

// This user's file of the appliance; its absence or its permissions are a check of their own.
Result<link::KnownAppliance> find_known(const link::Address& address, std::vector<DoctorCheck>& checks) {
  const auto appliances = link::KnownAppliances::of_this_user();
  auto known = appliances ? appliances->find(address) : std::unexpected(appliances.error());
  if (known) {
    checks.push_back(here("enrolment", "good", "kept in " + appliances->file(address).string()));
  } else {
    const bool none = known.error().code == ResultCode::kNotEnrolled;
    checks.push_back(here("enrolment", "failed", known.error().detail,
                          none ? "this user never enrolled there" : "the file is not as beltpick left it",
                          "'beltpick enrol --to " + address.text() + "'"));
  }
  return known;
}

}  // namespace

std::vector<DoctorCheck> doctor_checks(const link::Address& address, const link::Progress& meanwhile) {
  std::vector<DoctorCheck> checks;
  const auto known = find_known(address, checks);
  if (!passed(checks, check_name(address))) return checks;
  const auto contact = link::HttpClient::first_contact(address, link::route_path(ApiAction::kHealth));
  if (!contact) {
    add_silence(address, contact.error(), checks);
    return checks;
  }
  checks.push_back(open_port(address));
  const bool certified = passed(checks, check_certificate(*contact, known));
  const Json health = Json::parse(contact->health.body, nullptr, false);
  checks.push_back(check_versions(health));
  checks.push_back(check_clock(health));
  if (!known || !certified) return checks;
  link::Appliance appliance(*known);
  if (passed(checks, check_token(ask(appliance, ApiAction::kStatus), *known))) {
    add_self_test(appliance, checks, meanwhile);
  }
  return checks;
}

}  // namespace beltpick::cli
