// beltpick: the command line.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <vector>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::cli {
namespace {

struct Command {
  const char* name;
  const char* group;
  const char* summary;
  Run (*add)(CLI::App& app);
};

constexpr const char* kSetUp = "Setting up a cell";
constexpr const char* kMeasure = "Measuring";
constexpr const char* kAppliance = "An appliance over the network";
constexpr const char* kReference = "Reference";
constexpr const char* kTryOut = "Trying out without hardware";

// A line a command, in the order in which --help shows them.
constexpr Command kCommands[] = {
    {"patterns", kSetUp, "write the images that the projector shows, and sequence.json", add_patterns},
    {"calibrate", kSetUp, "find the geometry of camera and projector, compare and check it", add_calibrate},
    {"decode", kMeasure, "a capture to projector coordinates, and to a cloud", add_decode},
    {"segment", kMeasure, "the objects of a capture or a cloud", add_segment},
    {"primitives", kMeasure, "planes, cylinders and spheres of each object", add_primitives},
    {"teach", kSetUp, "make a part's template from its mesh or scan", add_teach},
    {"locate", kMeasure, "parts and their poses in a capture or a cloud", add_locate},
    {"simulate", kTryOut, "write captures of the virtual cell, with their truth", add_simulate},
    {"enrol", kAppliance, "make yourself known to an appliance, and its key to you", add_enrol},
    {"status", kAppliance, "how the cell is doing", add_status},
    {"doctor", kAppliance, "find out what hinders the cell", add_doctor},
    {"upload", kAppliance, "send calibration, cell, templates, recipes", add_upload},
    {"download", kAppliance, "fetch them, also older versions", add_download},
    {"items", kAppliance, "list what the appliance keeps, and its history", add_items},
    {"rollback", kAppliance, "make an older version current again", add_rollback},
    {"remove", kAppliance, "take a template or recipe out of use", add_remove},
    {"tokens", kAppliance, "who may do what there", add_tokens},
    {"flash", kSetUp, "give the trigger microcontroller a firmware", add_flash},
    {"registers", kReference, "print the PLC's registers and the result codes", add_registers},
};

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongUsage = 2, kBug = 3 };

// A command added to the program: its App, what it does and where its answer goes.
struct Added {
  CLI::App* app;
  Run run;
  std::unique_ptr<Session> session;
};

std::vector<Added> add_commands(CLI::App& program) {
  std::vector<Added> added;
  for (const Command& command : kCommands) {
    CLI::App* app = program.add_subcommand(command.name, command.summary)->group(command.group);
    auto session = std::make_unique<Session>(command.name);
    app->add_flag("--json", session->json, "answer in JSON, for machines");
    Run run = command.add(*app);
    added.push_back({app, std::move(run), std::move(session)});
  }
  return added;
}

bool is_command(const std::string& name) {
  return std::any_of(std::begin(kCommands), std::end(kCommands), [&](const Command& c) { return name == c.name; });
}

int refuse(const std::string& where, const std::string& what) {
  std::fprintf(stderr, "%s: %s; see '%s --help' [USAGE]\n", where.c_str(), contract_io::one_line(what).c_str(),
               where.c_str());
  return kWrongUsage;
}

int finish(const Added& command) {
  const Result<void> done = command.run(*command.session);
  if (!done) {
    command.session->fail(done.error());
    return done.error().code == ResultCode::kUsage ? kWrongUsage : kFailed;
  }
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return kDone;
  std::fprintf(stderr, "beltpick: stdout: expected to write the answer, found it closed or full [FILE_NOT_WRITTEN]\n");
  return kFailed;
}

int run_program(int argc, char** argv) {
  CLI::App program(
      "beltpick locates parts on a conveyor belt and tells a PLC or a robot where to grip them.\n"
      "'beltpick COMMAND --help' tells a command's options, with an example.",
      "beltpick");
  program.set_version_flag("--version", std::string("beltpick " BELTPICK_VERSION));
  const std::vector<Added> commands = add_commands(program);
  if (argc < 2) {
    std::fputs(program.help().c_str(), stderr);
    return kWrongUsage;
  }
  if (argv[1][0] != '-' && !is_command(argv[1])) {
    return refuse("beltpick", "expected a command, found '" + std::string(argv[1]) + "'");
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    const auto chosen = program.get_subcommands();
    return refuse(chosen.empty() ? "beltpick" : "beltpick " + chosen.front()->get_name(), error.what());
  }
  for (const Added& command : commands) {
    if (command.app->parsed()) return finish(command);
  }
  return refuse("beltpick", "expected a command");
}

}  // namespace
}  // namespace beltpick::cli

int main(int argc, char** argv) {
  using namespace beltpick;
  try {
    return cli::run_program(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "beltpick: out of memory; close other programs or use a smaller input [LIMIT_EXCEEDED]\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "beltpick: a fault in beltpick itself: %s; please report it [INTERNAL]\n",
                 contract_io::one_line(error.what()).c_str());
  }
  return cli::kBug;
}
