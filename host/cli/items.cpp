// beltpick items: what an appliance keeps, and the history of one item.
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"
#include "text_table.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct ItemsCommand {
  ItemWords item;
  std::string to;
};

std::string list_text(const Json& answer) {
  std::vector<std::vector<std::string>> rows{{"KIND", "NAME", "VERSION", "IN USE", "TIME", "BY", "BYTES"}};
  for (const Json& item : list_at(answer, "/items")) {
    const std::string in_use = words_at(item, "/in_use");
    rows.push_back({words_at(item, "/kind"), words_at(item, "/name"), words_at(item, "/current/version"),
                    in_use.empty() ? "-" : in_use, words_at(item, "/current/time"), words_at(item, "/current/by"),
                    words_at(item, "/current/bytes")});
  }
  return rows.size() > 1 ? text_table(rows) : "nothing is kept yet: 'beltpick upload' puts it there\n";
}

std::string history_text(const Json& answer) {
  std::vector<std::vector<std::string>> rows{{"VERSION", "TIME", "BY", "BYTES", "ORIGIN", "SHA-256"}};
  for (const Json& version : list_at(answer, "/versions")) {
    rows.push_back({words_at(version, "/version"), words_at(version, "/time"), words_at(version, "/by"),
                    words_at(version, "/bytes"), words_at(version, "/origin"),
                    words_at(version, "/sha256").substr(0, 16)});
  }
  return text_table(rows);
}

Result<void> run(const ItemsCommand& command, Session& session) {
  const bool all = command.item.kind.empty();
  const auto item = all ? link::RouteValues{} : item_of(command.item);
  if (!item) return std::unexpected(item.error());
  auto appliance = open_appliance(command.to);
  if (!appliance) return std::unexpected(appliance.error());
  const auto answer = ask(*appliance, all ? ApiAction::kListItems : ApiAction::kListVersions, *item);
  if (!answer) return std::unexpected(answer.error());
  session.answer(*answer, all ? list_text(*answer) : history_text(*answer));
  return {};
}

}  // namespace

Run add_items(CLI::App& app) {
  const auto command = std::make_shared<ItemsCommand>();
  add_item(app, command->item, false);
  add_to(app, command->to);
  example(app,
          "  beltpick items --to cell4.local\n"
          "  beltpick items template knuckle --to cell4.local");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
