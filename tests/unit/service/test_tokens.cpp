// Who has a token, who gets one, and what is on the disk of it.
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "contract/result_codes.hpp"
#include "service/secrets.hpp"
#include "service/tokens.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::service;
using namespace beltpick::test;

namespace {

TokenBook book_in(const std::filesystem::path& path) {
  std::vector<std::string> notes;
  auto book = TokenBook::open(std::move(*Folder::make(path)), notes);
  REQUIRE(book);
  return std::move(*book);
}

std::string one_time_token(const std::filesystem::path& path) {
  std::string text = file_bytes(path / kOneTimeTokenFile);
  REQUIRE(text.ends_with('\n'));
  text.pop_back();
  return text;
}

bool only_for_owner(const std::filesystem::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && (status.st_mode & 0777U) == 0600U;
}

template <class T>
ResultCode code_of(const Result<T>& result) {
  return result ? ResultCode::kOk : result.error().code;
}

}  // namespace

TEST_CASE("tokens are long, in hex, and never the same", "[tokens]") {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string token = random_token();
    CHECK(token.size() == 64);
    CHECK(token.find_first_not_of("0123456789abcdef") == std::string::npos);
    seen.insert(token);
  }
  CHECK(seen.size() == 1000);
  CHECK(same_secret("abc", "abc"));
  CHECK_FALSE(same_secret("abc", "abd"));
  CHECK_FALSE(same_secret("abc", "ab"));
}

TEST_CASE("the one-time token is traded once, and only its own", "[tokens]") {
  const TempFolder folder;
  TokenBook book = book_in(folder.path());
  const std::string first = one_time_token(folder.path());
  CHECK(only_for_owner(folder / kOneTimeTokenFile));
  CHECK_FALSE(book.find(first));

  CHECK(code_of(book.enrol(random_token(), "eve")) == ResultCode::kNotAuthorized);
  CHECK(code_of(book.enrol("", "eve")) == ResultCode::kNotAuthorized);
  CHECK(code_of(book.enrol(first, "no such name")) == ResultCode::kValueOutOfRange);
  const auto token = book.enrol(first, "anna");
  REQUIRE(token);
  CHECK(book.find(*token)->name == "anna");
  CHECK(book.find(*token)->role == Role::kCommissioner);
  CHECK_FALSE(std::filesystem::exists(folder / kOneTimeTokenFile));

  const auto replayed = book.enrol(first, "eve");
  REQUIRE_FALSE(replayed);
  CHECK(replayed.error().text().find("used already") != std::string_view::npos);
  CHECK(code_of(book.enrol("", "eve")) == ResultCode::kNotAuthorized);

  // Who can write into the state folder recovers, with the same name too.
  REQUIRE(write_one_time_token(*Folder::make(folder.path())));
  const auto again = book.enrol(one_time_token(folder.path()), "anna");
  REQUIRE(again);
  CHECK_FALSE(book.find(*token));
  CHECK(book.find(*again));
}

TEST_CASE("tokens outlive a restart and stand on the disk as digests, for their owner only", "[tokens]") {
  const TempFolder folder;
  std::string commissioner, viewer, used;
  {
    TokenBook book = book_in(folder.path());
    used = one_time_token(folder.path());
    commissioner = *book.enrol(used, "anna");
    viewer = *book.make("screen", Role::kViewer);
  }
  CHECK(only_for_owner(folder / "tokens.json"));
  const std::string text = file_bytes(folder / "tokens.json");
  for (const std::string& secret : {commissioner, viewer, used}) CHECK(text.find(secret) == std::string::npos);

  TokenBook book = book_in(folder.path());
  CHECK_FALSE(std::filesystem::exists(folder / kOneTimeTokenFile));
  CHECK(book.find(commissioner)->role == Role::kCommissioner);
  CHECK(book.find(viewer)->role == Role::kViewer);
  CHECK(book.find(viewer)->name == "screen");
  CHECK_FALSE(book.find(viewer.substr(1)));
  CHECK_FALSE(book.find(""));
  REQUIRE(write_one_time_token(*Folder::make(folder.path())));
  CHECK(code_of(book.enrol(used, "eve")) == ResultCode::kNotAuthorized);
}

TEST_CASE("names are unique, tokens bounded, the last commissioner stays", "[tokens]") {
  const TempFolder folder;
  TokenBook book = book_in(folder.path());
  REQUIRE(book.enrol(one_time_token(folder.path()), "anna"));
  CHECK(code_of(book.make("anna", Role::kViewer)) == ResultCode::kUsage);
  CHECK(code_of(book.make("../anna", Role::kViewer)) == ResultCode::kValueOutOfRange);
  CHECK(code_of(book.revoke("nobody")) == ResultCode::kFileNotFound);
  CHECK(code_of(book.revoke("anna")) == ResultCode::kUsage);
  const auto other = book.make("ben", Role::kCommissioner);
  REQUIRE(other);
  CHECK(book.revoke("anna"));
  CHECK(code_of(book.revoke("ben")) == ResultCode::kUsage);
  CHECK(book.find(*other));
  for (std::size_t i = book.entries().size(); i < TokenBook::kMaxTokens; ++i) {
    REQUIRE(book.make("screen" + std::to_string(i), Role::kViewer));
  }
  CHECK(code_of(book.make("one-more", Role::kViewer)) == ResultCode::kLimitExceeded);
  CHECK(book_in(folder.path()).entries().size() == TokenBook::kMaxTokens);
}

TEST_CASE("a damaged book is set aside: nobody gets in by it, and a one-time token is made", "[tokens]") {
  for (const char* damaged : {"", "{", "[]", "{\"format\": \"beltpick-tokens\", \"version\": 1, \"tokens\": [{}]}"}) {
    const TempFolder folder;
    REQUIRE(folder.file("tokens.json", damaged).string().size() > 0);
    std::vector<std::string> notes;
    auto book = TokenBook::open(std::move(*Folder::make(folder.path())), notes);
    REQUIRE(book);
    CHECK(book->entries().empty());
    CHECK(notes.size() == 2);
    CHECK(std::filesystem::exists(folder / "tokens.json.damaged"));
    CHECK(book->enrol(one_time_token(folder.path()), "anna"));
  }
}
