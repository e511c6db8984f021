#include "service/tokens.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/utc.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"
#include "service/secrets.hpp"
#include "service/sha256.hpp"

namespace beltpick::service {
namespace {

constexpr const char* kFile = "tokens.json";
constexpr const char* kFormat = "beltpick-tokens";
constexpr std::size_t kMaxFile = std::size_t{1} << 16U;
constexpr std::size_t kUsedKept = 16;

bool is_commissioner(const TokenBook::Entry& entry) { return entry.role == Role::kCommissioner; }

auto named(const std::string& name) {
  return [&name](const TokenBook::Entry& entry) { return entry.name == name; };
}

}  // namespace

Result<void> write_one_time_token(const Folder& state) {
  return write_secret(state, kOneTimeTokenFile, random_token() + "\n");
}

Result<TokenBook> TokenBook::open(Folder state, std::vector<std::string>& notes) {
  TokenBook book(std::move(state));
  if (const auto read = book.read(notes); !read) return std::unexpected(read.error());
  const bool waits = book.state_.read(kOneTimeTokenFile, kMaxFile).has_value();
  if (waits || std::any_of(book.entries_.begin(), book.entries_.end(), is_commissioner)) return book;
  if (const auto written = write_one_time_token(book.state_); !written) return std::unexpected(written.error());
  notes.push_back(std::string("nobody is enrolled yet: the one-time token is in the state folder, ") +
                  kOneTimeTokenFile);
  return book;
}

Result<void> TokenBook::read(std::vector<std::string>& notes) {
  const auto text = state_.read(kFile, kMaxFile);
  if (!text && text.error() == ENOENT) return {};
  if (!text) {
    return failure(ResultCode::kFileUnreadable, "%s in the state folder: expected to read it, found: %s", kFile,
                   std::strerror(text.error()));
  }
  const auto parsed = parse(*text);
  if (parsed) return {};
  notes.push_back(std::string(parsed.error().text()) + ": it is set aside, everybody must enrol anew");
  entries_.clear();
  used_.clear();
  if (state_.rename(kFile, std::string(kFile) + ".damaged") != 0) return parsed;
  return {};
}

Result<void> TokenBook::parse(const std::string& text) {
  contract_io::Warnings warnings;
  contract_io::JsonDocument document(text, kFile, warnings);
  contract_io::JsonObject root = document.root({kFormat}, 1);
  for (contract_io::JsonObject& token : root.objects("tokens")) {
    Entry entry;
    entry.name = token.text("name");
    entry.role = static_cast<Role>(token.choice("role", {role_name(Role::kNobody), role_name(Role::kViewer),
                                                         role_name(Role::kOperator), role_name(Role::kCommissioner)}));
    entry.time_utc = token.text("time");
    entry.sha256 = token.text("sha256");
    entries_.push_back(entry);
  }
  used_ = root.texts("used_one_time_tokens");
  if (document.failed()) return document.error();
  return {};
}

Result<void> TokenBook::write(const std::vector<Entry>& entries, const std::vector<std::string>& used) const {
  contract_io::Json json{{"format", kFormat}, {"version", 1}};
  json["tokens"] = contract_io::Json::array();
  for (const Entry& entry : entries) {
    json["tokens"].push_back(
        {{"name", entry.name}, {"role", role_name(entry.role)}, {"time", entry.time_utc}, {"sha256", entry.sha256}});
  }
  json["used_one_time_tokens"] = used;
  return write_secret(state_, kFile, contract_io::json_text(json));
}

std::optional<Caller> TokenBook::find(std::string_view token) const {
  const std::string digest = sha256_hex(token);
  std::optional<Caller> caller;
  for (const Entry& entry : entries_) {
    if (same_secret(digest, entry.sha256)) caller = Caller{entry.name, entry.role};
  }
  return caller;
}

Result<void> TokenBook::check_new(const std::string& name) const {
  if (!is_item_name(name)) {
    return failure(ResultCode::kValueOutOfRange,
                   "name: expected at most %zu letters, digits, '.', '_', '-', found \"%.80s\"; choose another",
                   kMaxItemName, name.c_str());
  }
  if (std::any_of(entries_.begin(), entries_.end(), named(name))) {
    return failure(ResultCode::kUsage, "name: expected a new one, found \"%s\", which has a token; revoke it first",
                   name.c_str());
  }
  if (entries_.size() < kMaxTokens) return {};
  return failure(ResultCode::kLimitExceeded, "tokens: expected at most %zu, found as many; revoke some", kMaxTokens);
}

Result<std::string> TokenBook::make(const std::string& name, Role role) {
  if (const auto good = check_new(name); !good) return std::unexpected(good.error());
  const std::string token = random_token();
  auto entries = entries_;
  entries.push_back({name, role, now_utc(), sha256_hex(token)});
  if (const auto written = write(entries, used_); !written) return std::unexpected(written.error());
  entries_ = std::move(entries);
  return token;
}

Result<std::string> TokenBook::enrol(std::string_view one_time_token, const std::string& name) {
  const std::string digest = sha256_hex(one_time_token);
  if (std::find(used_.begin(), used_.end(), digest) != used_.end()) {
    return failure(ResultCode::kNotAuthorized,
                   "token: expected a one-time token, found one that was used already; "
                   "beltpickd --new-one-time-token makes another");
  }
  auto waiting = state_.read(kOneTimeTokenFile, kMaxFile);
  while (waiting && waiting->ends_with('\n')) waiting->pop_back();
  if (!waiting || waiting->empty() || !same_secret(sha256_hex(*waiting), digest)) {
    return failure(ResultCode::kNotAuthorized,
                   "token: expected the one-time token of the appliance's state folder, "
                   "found another; beltpickd --new-one-time-token makes one");
  }
  auto entries = entries_;
  std::erase_if(entries, named(name));
  std::swap(entries, entries_);
  const auto good = check_new(name);
  std::swap(entries, entries_);
  if (!good) return std::unexpected(good.error());
  // First it works no more, then what it gives is made: interrupted in between, another one-time token is needed.
  auto used = used_;
  used.push_back(digest);
  if (used.size() > kUsedKept) used.erase(used.begin());
  const std::string token = random_token();
  entries.push_back({name, Role::kCommissioner, now_utc(), sha256_hex(token)});
  if (const auto gone = remove_secret(state_, kOneTimeTokenFile); !gone) return std::unexpected(gone.error());
  if (const auto written = write(entries, used); !written) return std::unexpected(written.error());
  entries_ = std::move(entries);
  used_ = std::move(used);
  return token;
}

Result<void> TokenBook::revoke(const std::string& name) {
  auto entries = entries_;
  if (std::erase_if(entries, named(name)) == 0) {
    return failure(ResultCode::kFileNotFound, "token %.80s: expected one of that name, found none; list them first",
                   name.c_str());
  }
  if (std::none_of(entries.begin(), entries.end(), is_commissioner) &&
      std::any_of(entries_.begin(), entries_.end(), is_commissioner)) {
    return failure(ResultCode::kUsage, "token %s: expected another commissioner to be left, found none; make one first",
                   name.c_str());
  }
  if (const auto written = write(entries, used_); !written) return std::unexpected(written.error());
  entries_ = std::move(entries);
  return {};
}

}  // namespace beltpick::service
