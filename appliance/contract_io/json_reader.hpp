// Strict reading of a JSON file: every error names the file, the member, what was expected and what was found.
//
// A reader keeps the first error and then answers with harmless values, so that a parser reads straight through and
// asks once at the end:
//
//   JsonDocument document(text, "capture.json", warnings);
//   JsonObject root = document.root({"beltpick-capture"}, 1);
//   header.full_scale = root.integer("full_scale", {1, 65535}, 255);
//   root.finish();                                     // members nobody asked for warn
//   if (document.failed()) return document.error();
#pragma once

#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

class JsonObject;

class JsonDocument {
 public:
  // `name` stands in messages. Malformed JSON is the first error.
  JsonDocument(std::string_view text, std::string name, Warnings& warnings);

  // The top-level object, after checking that its `format` is one of `formats` and its `version` the one known.
  JsonObject root(std::initializer_list<std::string_view> formats, int version);
  // The top-level object of a message, which has no format of its own.
  JsonObject message();

  [[nodiscard]] bool failed() const { return error_.has_value(); }
  [[nodiscard]] std::unexpected<Error> error() const { return std::unexpected(*error_); }

  // Keeps the first error: "<file>: <member>: expected <expected>, found <found>; <remedy>".
  void fail(ResultCode code, std::string_view member, std::string_view expected, std::string_view found,
            std::string_view remedy = "correct this member");
  void warn(const std::string& text);

 private:
  std::string name_;
  nlohmann::json value_;
  Warnings& warnings_;
  std::optional<Error> error_;
};

// What stands there, short enough for a message.
std::string describe(const nlohmann::json& value);

struct Between {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool above_low = false;  // low itself is not allowed
};

// One object of the document. Cheap to copy except for the list of members asked for.
class JsonObject {
 public:
  JsonObject(JsonDocument& document, const nlohmann::json* value, std::string path);

  [[nodiscard]] bool has(std::string_view member);
  [[nodiscard]] bool is_object(std::string_view member);
  [[nodiscard]] std::string path(std::string_view member) const;

  // Required where no default is given.
  double number(std::string_view member, Between between = {}, std::optional<double> fallback = {});
  int integer(std::string_view member, Between between, std::optional<int> fallback = {});
  bool flag(std::string_view member, std::optional<bool> fallback = {});
  std::string text(std::string_view member, std::optional<std::string> fallback = {});
  // The position of the member's text among `choices`.
  int choice(std::string_view member, std::initializer_list<std::string_view> choices,
             std::optional<int> fallback = {});

  // Numbers, row after row: rows x columns nested arrays, or one array of `columns` where rows is 0.
  std::vector<double> numbers(std::string_view member, int rows, int columns);

  // How many items the array `member` has; 0 where it is none.
  std::size_t length(std::string_view member);

  // Up to `most` numbers; none where the member is missing.
  std::vector<double> number_list(std::string_view member, Between between, std::size_t most);

  // Texts; required, perhaps none.
  std::vector<std::string> texts(std::string_view member);

  // An array of matrices, each as numbers() gives it.
  std::vector<std::vector<double>> matrices(std::string_view member, int rows, int columns);

  JsonObject object(std::string_view member);
  // The members of an array of objects; empty after an error.
  std::vector<JsonObject> objects(std::string_view member);

  // A member whose content is not read here, but is no surprise either.
  void ignore(std::string_view member) { (void)find(member); }

  // Warns of members nobody asked for.
  void finish();

  void fail(ResultCode code, std::string_view member, std::string_view expected, std::string_view found) {
    document_->fail(code, path(member), expected, found);
  }

 private:
  const nlohmann::json* find(std::string_view member);
  const nlohmann::json* require(std::string_view member, std::string_view expected, bool optional);

  JsonDocument* document_;
  const nlohmann::json* value_;  // null after an error
  std::string path_;
  std::vector<std::string> asked_;
};

}  // namespace beltpick::contract_io
