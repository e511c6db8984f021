// TokenBook: who may ask the service for what. Tokens are 256 random bits; the appliance keeps their SHA-256 only, in
// <state>/tokens.json. The first token is had for the one-time token, which stands in a file that only the appliance's
// user can read, and works once.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "service/folder.hpp"
#include "service/messages.hpp"

namespace beltpick::service {

inline constexpr const char* kOneTimeTokenFile = "one_time_token";

// Writes a new one-time token into the state folder; an older one works no more. A service that runs takes the new one.
// Error: kFileNotWritten.
Result<void> write_one_time_token(const Folder& state);

// A person with one token; one thread.
class TokenBook {
 public:
  static constexpr std::size_t kMaxTokens = 64;

  struct Entry {
    std::string name;  // is_item_name()
    Role role = Role::kViewer;
    std::string time_utc;  // when it was made
    std::string sha256;    // of the token
  };

  // Reads <state>/tokens.json; where there is none, or none with a commissioner, and no one-time token waits, makes one
  // and says so in `notes`. A damaged file is set aside: everybody enrols anew. Errors: kFileUnreadable,
  // kFileNotWritten.
  static Result<TokenBook> open(Folder state, std::vector<std::string>& notes);

  // Whose token it is; nothing for one that is not known.
  [[nodiscard]] std::optional<Caller> find(std::string_view token) const;
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  // A new token. Errors: kValueOutOfRange (name), kUsage (the name is taken), kLimitExceeded, kFileNotWritten.
  Result<std::string> make(const std::string& name, Role role);
  // A commissioner's token for the one-time token, which is gone then. A token of that name is replaced: who holds the
  // one-time token may. Errors: kNotAuthorized (wrong, or used already), those of make().
  Result<std::string> enrol(std::string_view one_time_token, const std::string& name);
  // Errors: kFileNotFound, kUsage (the last commissioner stays), kFileNotWritten.
  Result<void> revoke(const std::string& name);

 private:
  explicit TokenBook(Folder state) : state_(std::move(state)) {}

  Result<void> read(std::vector<std::string>& notes);
  Result<void> parse(const std::string& text);
  [[nodiscard]] Result<void> write(const std::vector<Entry>& entries, const std::vector<std::string>& used) const;
  [[nodiscard]] Result<void> check_new(const std::string& name) const;

  Folder state_;
  std::vector<Entry> entries_;
  std::vector<std::string> used_;  // SHA-256 of the last one-time tokens: a replay is told from a mistyped one
};

}  // namespace beltpick::service
