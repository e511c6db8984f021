// beltpick enrol: makes this user known to an appliance, and its key to this user.
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "appliance_call.hpp"
#include "base/utc.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "options.hpp"
#include "terminal.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct EnrolCommand {
  std::string to;
  std::string token_file;
  std::string access_token_file;
  std::string fingerprint;
  std::string name;
};

std::string trimmed(const std::string& text) {
  const auto from = text.find_first_not_of(" \t\r\n");
  const auto to = text.find_last_not_of(" \t\r\n");
  return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

// "anna-laptop": who enrols, as the appliance will list it.
std::string default_name() {
  char host[256]{};
  gethostname(host, sizeof host - 1);
  const passwd* user = getpwuid(geteuid());
  std::string name = (user != nullptr ? std::string(user->pw_name) : "user") + "-" + host;
  std::replace_if(
      name.begin(), name.end(),
      [](char c) {
        return !is_item_name(std::string{'a', c});
      },
      '_');
  if (!is_item_name(name.substr(0, 1))) name.insert(0, "u");
  return name.substr(0, kMaxItemName);
}

// A token is one word of printable characters; anything else would not pass through a header.
Result<std::string> read_token(const std::string& file) {
  std::string text;
  if (file.empty() || file == "-") {
    if (auto typed = read_secret("one-time token: "); typed) text = *typed;
  } else {
    const auto read = contract_io::read_file(file, 4096);
    if (!read) return read;
    text = *read;
  }
  text = trimmed(text);
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 0x7f; });
  if (!text.empty() && plain) return text;
  return failure(ResultCode::kUsage,
                 "--token: expected a token of one word, found %s; see one_time_token in the state "
                 "folder of the appliance",
                 text.empty() ? "none" : "other characters");
}

// The key to trust: the one demanded, the one known, or the one shown, which a person confirms where there is one.
Result<link::Fingerprint> trusted_key(const EnrolCommand& command, const link::Address& address,
                                      const link::KnownAppliances& appliances, Session& session) {
  const auto contact = link::HttpClient::first_contact(address, link::route_path(ApiAction::kHealth));
  if (!contact) return std::unexpected(contact.error());
  const link::Fingerprint shown = contact->fingerprint;
  if (!command.fingerprint.empty()) {
    const auto demanded = link::parse_fingerprint(command.fingerprint, "--fingerprint");
    if (!demanded) return failure(ResultCode::kUsage, "%s", demanded.error().detail);
    if (*demanded == shown) return shown;
    return failure(ResultCode::kCertificateChanged,
                   "%s: expected the key %s, found %s; something else answers there: "
                   "check address and appliance",
                   address.text().c_str(), demanded->text().c_str(), shown.text().c_str());
  }
  const auto known = appliances.find(address);
  if (known && known->fingerprint == shown) return shown;
  if (known && !is_interactive()) {
    return failure(ResultCode::kCertificateChanged,
                   "%s: expected the key %s, found %s; check on the appliance that this is its own, then give it with "
                   "--fingerprint",
                   address.text().c_str(), known->fingerprint.text().c_str(), shown.text().c_str());
  }
  const std::string shows = address.text() + " shows the key " + shown.text();
  if (!is_interactive()) {
    session.warn({shows + "; taken at first contact, compare it with the one in the appliance's log"});
    return shown;
  }
  if (known) std::fprintf(stderr, "The key has changed! Known until now: %s\n", known->fingerprint.text().c_str());
  if (confirm(shows + "\nIs it the one in the appliance's log? [y/N] ")) return shown;
  return failure(ResultCode::kNotEnrolled, "%s: not enrolled: its key was not confirmed", address.text().c_str());
}

// A token that a commissioner made for this user is kept as it is, once the appliance takes it.
Result<link::KnownAppliance> with_access_token(const link::Address& address, const link::Fingerprint& key,
                                               const std::string& token) {
  link::Appliance appliance({address, key, token, {}, {}, {}});
  const auto status = ask(appliance, ApiAction::kStatus);
  if (!status) return std::unexpected(status.error());
  return link::KnownAppliance{address, key, token, {}, words_at(*status, "/role"), {}};
}

Result<link::KnownAppliance> introduce(const EnrolCommand& command, const link::Address& address,
                                       const link::Fingerprint& key) {
  const bool made = !command.access_token_file.empty();
  const auto token = read_token(made ? command.access_token_file : command.token_file);
  if (!token) return std::unexpected(token.error());
  if (made) return with_access_token(address, key, *token);
  return link::enrol(address, key, *token, command.name.empty() ? default_name() : command.name);
}

Result<void> run(const EnrolCommand& command, Session& session) {
  const auto address = link::parse_address(command.to);
  if (!address) return std::unexpected(address.error());
  if (!command.name.empty() && !is_item_name(command.name)) {
    return failure(ResultCode::kUsage, "--name: expected letters, digits, '.', '_' and '-', at most %zu, found '%s'",
                   kMaxItemName, contract_io::one_line(command.name).substr(0, 80).c_str());
  }
  const auto appliances = link::KnownAppliances::of_this_user();
  if (!appliances) return std::unexpected(appliances.error());
  const auto key = trusted_key(command, *address, *appliances, session);
  if (!key) return std::unexpected(key.error());
  if (auto ready = appliances->prepare(); !ready) return ready;
  auto known = introduce(command, *address, *key);
  if (!known) return std::unexpected(known.error());
  known->enrolled_utc = now_utc();
  if (auto kept = appliances->keep(*known); !kept) return kept;
  const std::string file = appliances->file(*address).string();
  session.answer(
      Json{{"address", address->text()},
           {"fingerprint", key->text()},
           {"name", known->name},
           {"role", known->role},
           {"file", file}},
      address->text() + ": enrolled as " + known->role + "; key " + key->text() + "; kept in " + file + "\n");
  return {};
}

}  // namespace

Run add_enrol(CLI::App& app) {
  const auto command = std::make_shared<EnrolCommand>();
  add_to(app, command->to);
  auto* token =
      app.add_option("--token", command->token_file,
                     "file with the appliance's one-time token; without it, or with -, from stdin or asked for");
  token->type_name("FILE");
  app.add_option("--access-token", command->access_token_file, "file with a token that 'beltpick tokens make' gave")
      ->type_name("FILE")
      ->excludes(token);
  app.add_option("--fingerprint", command->fingerprint, "the key that the appliance must show, as its log prints it")
      ->type_name("sha256:HEX");
  app.add_option("--name", command->name, "what the appliance shall call this user (default user and host)");
  example(app,
          "  beltpick enrol --to cell4.local --token one_time_token\n"
          "  beltpick enrol --to cell4.local --access-token token_of_anna --fingerprint sha256:7f3a...");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
