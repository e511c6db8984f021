// beltpick tokens: who may talk to an appliance, and in which role.
#include <algorithm>
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "link/private_file.hpp"
#include "options.hpp"
#include "text_table.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct TokensCommand {
  std::string action;
  std::string name;
  std::string to;
  std::string role = std::string(role_name(Role::kViewer));
  std::string out;
};

Result<void> check(const TokensCommand& command) {
  if ((command.action == "list") != command.name.empty()) {
    return failure(ResultCode::kUsage, "%s: expected %s", command.action.c_str(),
                   command.name.empty() ? "the token's NAME" : "no NAME");
  }
  if (command.action == "make" && command.out.empty()) {
    return failure(ResultCode::kUsage, "make: expected --out FILE for the token, found none");
  }
  if (command.name.empty() || is_item_name(command.name)) return {};
  return failure(ResultCode::kUsage, "expected a name of letters, digits, '.', '_' and '-', at most %zu, found '%s'",
                 kMaxItemName, contract_io::one_line(command.name).substr(0, 80).c_str());
}

Result<void> list(link::Appliance& appliance, Session& session) {
  const auto answer = ask(appliance, ApiAction::kListTokens);
  if (!answer) return std::unexpected(answer.error());
  std::vector<std::vector<std::string>> rows{{"NAME", "ROLE", "SINCE"}};
  for (const Json& token : list_at(*answer, "/tokens")) {
    rows.push_back({words_at(token, "/name"), words_at(token, "/role"), words_at(token, "/time")});
  }
  session.answer(*answer, text_table(rows));
  return {};
}

// The token goes into a file that only this user may read, and nowhere else.
Result<void> make(link::Appliance& appliance, const TokensCommand& command, Session& session) {
  const auto answer =
      ask(appliance, ApiAction::kMakeToken, {}, Json{{"name", command.name}, {"role", command.role}}.dump());
  if (!answer) return std::unexpected(answer.error());
  if (auto written = link::write_private_file(command.out, words_at(*answer, "/token") + "\n"); !written) {
    (void)ask(appliance, ApiAction::kRevokeToken, {{}, command.name, {}});  // nobody has it
    return written;
  }
  session.answer({{"name", command.name}, {"role", command.role}, {"file", command.out}},
                 command.out + ": token of " + command.name + ", " + command.role + "; it is shown nowhere else\n");
  return {};
}

Result<void> revoke(link::Appliance& appliance, const TokensCommand& command, Session& session) {
  const auto answer = ask(appliance, ApiAction::kRevokeToken, {{}, command.name, {}});
  if (!answer) return std::unexpected(answer.error());
  session.answer(*answer, command.name + ": revoked\n");
  return {};
}

Result<void> run(const TokensCommand& command, Session& session) {
  if (auto good = check(command); !good) return good;
  auto appliance = open_appliance(command.to);
  if (!appliance) return std::unexpected(appliance.error());
  if (command.action == "make") return make(*appliance, command, session);
  if (command.action == "revoke") return revoke(*appliance, command, session);
  return list(*appliance, session);
}

}  // namespace

Run add_tokens(CLI::App& app) {
  const auto command = std::make_shared<TokensCommand>();
  app.add_option("action", command->action, "list, make or revoke")
      ->required()
      ->type_name("ACTION")
      ->check(CLI::IsMember({"list", "make", "revoke"}));
  app.add_option("name", command->name, "of the token to make or revoke")->type_name("NAME");
  add_to(app, command->to);
  std::vector<std::string> roles = choices(kRoleNames);
  roles.erase(roles.begin());  // nobody
  app.add_option("--role", command->role, "make: viewer, operator or commissioner (default viewer)")
      ->check(CLI::IsMember(roles));
  app.add_option("--out", command->out, "make: the file for the token, mode 600")->type_name("FILE");
  example(app,
          "  beltpick tokens list --to cell4.local\n"
          "  beltpick tokens make anna --role operator --out token_of_anna --to cell4.local\n"
          "  beltpick tokens revoke anna --to cell4.local");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
