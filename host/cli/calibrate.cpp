// beltpick calibrate: actions on a calibration.
#include <memory>

#include "calibrate_actions.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"

namespace beltpick::cli {

Run add_calibrate(CLI::App& app) {
  const auto actions = std::make_shared<CalibrateActions>(app);
  example(app, "  beltpick calibrate diff old.json new.json --cell cell.json");
  return [actions](Session& session) -> Result<void> {
    if (actions->chosen()) return actions->run(session);
    return failure(ResultCode::kUsage, "expected an action such as diff, found none");
  };
}

}  // namespace beltpick::cli
