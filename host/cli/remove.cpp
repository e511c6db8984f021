// beltpick remove: takes a template or recipe out of use on an appliance.
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"

namespace beltpick::cli {
namespace {

struct RemoveCommand {
  ItemWords item;
  std::string to;
};

Result<void> run(const RemoveCommand& command, Session& session) {
  const auto item = item_of(command.item);
  if (!item) return std::unexpected(item.error());
  if (item_kind(*find_item_kind(item->kind)).single) {
    return failure(ResultCode::kUsage,
                   "%s: expected a template or recipe: a cell cannot be without its %s; upload another",
                   item->kind.c_str(), item->kind.c_str());
  }
  auto appliance = open_appliance(command.to);
  if (!appliance) return std::unexpected(appliance.error());
  const auto answer = ask(*appliance, ApiAction::kRemove, *item);
  if (!answer) return std::unexpected(answer.error());
  session.answer(*answer, item_words(*item) + ": out of use; 'beltpick rollback' brings it back\n");
  return {};
}

}  // namespace

Run add_remove(CLI::App& app) {
  const auto command = std::make_shared<RemoveCommand>();
  add_item(app, command->item);
  add_to(app, command->to);
  example(app, "  beltpick remove recipe brackets --to cell4.local");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
