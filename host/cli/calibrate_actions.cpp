#include "calibrate_actions.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"

namespace beltpick::cli {
namespace {

struct Entry {
  const char* name;
  const char* summary;
  Run (*add)(CLI::App& app);
};

constexpr Entry kActions[] = {
    {"diff", "how far apart two calibrations measure, in mm", add_calibrate_diff},
    {"verify", "whether a calibration still holds, by one capture of the plate", add_calibrate_verify},
    {"belt", "where the belt is, from a capture of it, into cell.json", add_calibrate_belt},
};

}  // namespace

CalibrateActions::CalibrateActions(CLI::App& calibrate) : calibrate_(&calibrate) {
  calibrate.require_subcommand(0, 1);
  for (const Entry& entry : kActions) {
    CLI::App* app = calibrate.add_subcommand(entry.name, entry.summary)->group("Actions");
    auto json = std::make_shared<bool>(false);
    app->add_flag("--json", *json, "answer in JSON, for machines");
    Run run = entry.add(*app);
    actions_.push_back({app, std::move(run), std::move(json)});
  }
}

bool CalibrateActions::chosen() const {
  return std::any_of(actions_.begin(), actions_.end(), [](const Action& action) { return action.app->parsed(); });
}

Result<void> CalibrateActions::run(Session& session) const {
  for (const Action& action : actions_) {
    if (!action.app->parsed()) continue;
    for (const CLI::Option* option : calibrate_->get_options()) {
      if (option->count() == 0 || option->check_lname("json")) continue;
      return failure(ResultCode::kUsage,
                     "%s stands before '%s', which does not take it; see 'beltpick calibrate %s --help'",
                     option->get_name().c_str(), action.app->get_name().c_str(), action.app->get_name().c_str());
    }
    session.json = session.json || *action.json;
    return action.run(session);
  }
  return {};
}

}  // namespace beltpick::cli
