// beltpickd: the appliance.
#include <malloc.h>

#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>

#include "app/appliance.hpp"
#include "app/state_owner.hpp"
#include "contract/result_codes.hpp"
#include "service/self_test_text.hpp"
#include "service/service.hpp"

namespace {

using namespace beltpick;

constexpr const char* kHelp =
    "beltpickd: locates parts on a conveyor belt and offers their poses to a PLC\n"
    "\n"
    "  beltpickd --config FILE            run until SIGTERM; SIGHUP reads the model files anew\n"
    "  beltpickd --config FILE --check    judge configuration and files, print the memory budget, exit\n"
    "  beltpickd --config FILE --self-test [--json]    test camera, trigger box, network, files and limits, exit\n"
    "  beltpickd --config FILE --new-one-time-token    write a token that enrols an engineer once into the state "
    "folder\n"
    "  beltpickd --config FILE --outputs-off    make the digital outputs of this PC inactive, exit: after a crash\n"
    "  beltpickd --print-config           print the default configuration with every key's meaning\n"
    "  beltpickd --help\n"
    "\n"
    "Example: beltpickd --print-config > beltpickd.toml; edit it; beltpickd --config beltpickd.toml --check\n"
    "\n"
    "The log goes to stderr. Exit codes: 0 clean stop, 1 cannot start or a check failed, 2 wrong command line, 3 a "
    "thread hung.\n";

struct Options {
  std::string config;
  bool check = false;
  bool self_test = false;
  bool json = false;
  bool new_one_time_token = false;
  bool outputs_off = false;
  bool print_config = false;
  bool help = false;
};

std::optional<Options> parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--config" && i + 1 < argc) {
      options.config = argv[++i];
    } else if (argument.starts_with("--config=")) {
      options.config = argument.substr(std::strlen("--config="));
    } else if (argument == "--check") {
      options.check = true;
    } else if (argument == "--self-test") {
      options.self_test = true;
    } else if (argument == "--json") {
      options.json = true;
    } else if (argument == "--new-one-time-token") {
      options.new_one_time_token = true;
    } else if (argument == "--outputs-off") {
      options.outputs_off = true;
    } else if (argument == "--print-config") {
      options.print_config = true;
    } else if (argument == "--help" || argument == "-h") {
      options.help = true;
    } else {
      std::fprintf(stderr, "beltpickd: '%s': expected an option that --help names, found another; see --help\n",
                   argument.c_str());
      return std::nullopt;
    }
  }
  if (options.help || options.print_config || !options.config.empty()) return options;
  std::fprintf(stderr, "beltpickd: expected --config FILE, found none; see --help\n");
  return std::nullopt;
}

int fail(const Error& error) {
  std::fprintf(stderr, "beltpickd: %s: %s\n", result_code_name(error.code).data(), error.detail);
  return 1;
}

int make_one_time_token(const app::Settings& settings) {
  if (settings.state.empty()) {
    return fail(failure(ResultCode::kUsage, "service.state: expected a state folder, found none; set it").error());
  }
  const auto state = app::from_settings(settings, settings.state);
  if (const auto became = app::become_owner_of(state); !became) return fail(became.error());
  const auto path = service::new_one_time_token(state);
  if (!path) return fail(path.error());
  std::printf("%s holds a token that enrols once: beltpick enrol --to HOST\n", path->c_str());
  return 0;
}

// The table says all that the log would.
int self_test(const app::Settings& settings, app::Log& log, bool json) {
  app::Appliance appliance(settings, log);
  if (const auto opened = appliance.open_state(app::Appliance::State::kLook); !opened) return fail(opened.error());
  (void)appliance.load();  // what is wrong is what the self-test tells
  const service::SelfTestReport report = appliance.self_test_alone();
  std::fputs((json ? service::self_test_json(report) : service::self_test_table(report)).c_str(), stdout);
  std::fflush(stdout);
  const int code = report.worst() == service::Verdict::kFailed ? 1 : 0;
  if (!appliance.can_be_taken_down()) std::_Exit(code);
  return code;
}

// A line that is taken is inactive; some chips keep a line's level when a process that held it dies.
int outputs_off(const app::Settings& settings) {
  const auto opened = app::Wiring(settings).open();
  return opened ? 0 : fail(opened.error());
}

int serve(const Options& options, app::Log& log) {
  std::vector<std::string> warnings;
  const auto settings = app::read_settings(options.config, warnings);
  if (!settings) return fail(settings.error());
  if (options.self_test) return self_test(*settings, log, options.json);
  if (options.new_one_time_token) return make_one_time_token(*settings);
  if (options.outputs_off) return outputs_off(*settings);
  for (const std::string& warning : warnings) log.write(app::LogLevel::kWarning, "%s", warning.c_str());

  if (!options.check) app::Appliance::leave_signals_to_supervisor();
  app::Appliance appliance(*settings, log);
  std::fputs(appliance.budget_text().c_str(), options.check ? stdout : stderr);
  if (!options.check) appliance.lock_memory();
  const auto state = options.check ? app::Appliance::State::kLook : app::Appliance::State::kKeep;
  if (const auto opened = appliance.open_state(state); !opened) return fail(opened.error());
  const auto loaded = appliance.load();
  log.drain(2);
  if (options.check) {
    if (!loaded) return fail(loaded.error());
    std::puts("the configuration and all files are good");
    return 0;
  }
  if (const auto opened = appliance.open_lines(); !opened) return fail(opened.error());
  const auto ended = appliance.run();
  return ended ? *ended : fail(ended.error());
}

}  // namespace

int main(int argc, char** argv) {
  const auto options = parse(argc, argv);
  if (!options) return 2;
  if (options->help) {
    std::fputs(kHelp, stdout);
    return 0;
  }
  if (options->print_config) {
    std::fputs(app::default_settings_text().c_str(), stdout);
    return 0;
  }
  ::mallopt(M_ARENA_MAX, 2);  // few threads ever allocate: no heap of their own for each
  app::Log log;
  try {
    return serve(*options, log);
  } catch (const std::exception& problem) {
    log.drain(2);
    std::fprintf(stderr, "beltpickd: cannot start: %s\n", problem.what());
    return 1;
  }
}
