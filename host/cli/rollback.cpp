// beltpick rollback: makes an older version of an item current again.
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct RollbackCommand {
  ItemWords item;
  std::string to;
  unsigned version = 0;  // 0: the one before the current one
};

Result<void> run(const RollbackCommand& command, Session& session) {
  const auto item = item_of(command.item);
  if (!item) return std::unexpected(item.error());
  auto appliance = open_appliance(command.to);
  if (!appliance) return std::unexpected(appliance.error());
  const std::string body = command.version > 0 ? Json{{"version", command.version}}.dump() : "{}";
  const auto answer = ask(*appliance, ApiAction::kRollback, *item, body);
  if (!answer) return std::unexpected(answer.error());
  session.answer(*answer, item_words(*item) + ": " + version_words(*answer) + "\n");
  return {};
}

}  // namespace

Run add_rollback(CLI::App& app) {
  const auto command = std::make_shared<RollbackCommand>();
  add_item(app, command->item);
  add_to(app, command->to);
  app.add_option("--version", command->version, "which one (default: the one before); 'beltpick items' lists them")
      ->check(CLI::Range(1U, 4'000'000'000U));
  example(app,
          "  beltpick rollback template knuckle --to cell4.local\n"
          "  beltpick rollback calibration --to cell4.local --version 3");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
