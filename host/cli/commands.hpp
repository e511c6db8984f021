// The commands of beltpick: each in the file of its name.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "session.hpp"

namespace beltpick::cli {

// What a command does once the command line is parsed. A failure is printed as one line; the program then exits with 1.
using Run = std::function<Result<void>(Session&)>;

// Adds a command's options to `app` and returns what it does. Every command calls example(); --json is there already.
Run add_patterns(CLI::App& app);
Run add_calibrate(CLI::App& app);
Run add_decode(CLI::App& app);
Run add_segment(CLI::App& app);
Run add_primitives(CLI::App& app);
Run add_locate(CLI::App& app);
Run add_registers(CLI::App& app);
Run add_teach(CLI::App& app);
Run add_simulate(CLI::App& app);
Run add_enrol(CLI::App& app);
Run add_upload(CLI::App& app);
Run add_download(CLI::App& app);
Run add_items(CLI::App& app);
Run add_rollback(CLI::App& app);
Run add_remove(CLI::App& app);
Run add_status(CLI::App& app);
Run add_doctor(CLI::App& app);
Run add_tokens(CLI::App& app);
Run add_flash(CLI::App& app);

}  // namespace beltpick::cli
