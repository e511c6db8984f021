// What beltpick calibrate does beside calibrating: actions on a calibration that is there already, each in the file of
// its name (calibrate_diff.cpp ...).
#pragma once

#include <memory>
#include <vector>

#include "commands.hpp"

namespace beltpick::cli {

// Each adds an action's options to its own `app` and returns what it does, as the commands of commands.hpp.
Run add_calibrate_belt(CLI::App& app);
Run add_calibrate_diff(CLI::App& app);
Run add_calibrate_verify(CLI::App& app);

class CalibrateActions {
 public:
  // Adds the actions to the command `calibrate`.
  explicit CalibrateActions(CLI::App& calibrate);

  // Whether the command line names one of them. Then run() does it, and the options of `calibrate` itself are not
  // for it: kUsage where some were given.
  [[nodiscard]] bool chosen() const;
  Result<void> run(Session& session) const;

 private:
  struct Action {
    CLI::App* app;
    Run run;
    std::shared_ptr<bool> json;
  };

  CLI::App* calibrate_;
  std::vector<Action> actions_;
};

}  // namespace beltpick::cli
