#include "contract_io/json_reader.hpp"

#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::contract_io {
namespace {

constexpr std::size_t kShown = 48;  // characters of a value in a message

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string range_text(const char* what, const Between& between) {
  const bool low = between.low > -std::numeric_limits<double>::max();
  const bool high = between.high < std::numeric_limits<double>::max();
  std::string text = what;
  if (low) text += (between.above_low ? " greater than " : " of at least ") + number_text(between.low);
  if (high) text += (low ? " and at most " : " of at most ") + number_text(between.high);
  return text;
}

bool inside(double value, const Between& between) {
  return std::isfinite(value) && value <= between.high &&
         (between.above_low ? value > between.low : value >= between.low);
}

// A scalar, or an array of scalars or of arrays of them: what can be printed without following any depth of nesting.
bool is_table(const nlohmann::json& value) {
  const auto flat = [](const nlohmann::json& row) {
    return std::none_of(row.begin(), row.end(), [](const auto& item) { return item.is_structured(); });
  };
  return !value.is_array() || std::all_of(value.begin(), value.end(), [&](const nlohmann::json& row) {
    return !row.is_structured() || (row.is_array() && flat(row));
  });
}

std::string position_text(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  return "line " + std::to_string(line);
}

}  // namespace

std::string describe(const nlohmann::json& value) {
  if (value.is_object()) return "an object";
  if (!is_table(value)) return "an array of " + std::to_string(value.size());
  std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return text;
}

JsonDocument::JsonDocument(std::string_view text, std::string name, Warnings& warnings)
    : name_(std::move(name)), warnings_(warnings) {
  try {
    value_ = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const bool empty = text.find_first_not_of(" \t\r\n") == std::string_view::npos;
    const bool cut = error.byte >= text.size();
    fail(ResultCode::kFormatInvalid, position_text(text, error.byte), "JSON",
         empty ? "nothing" : (cut ? "an end too early" : "something else"),
         cut ? "the file is cut off: write it again" : "correct it at this line");
  } catch (const nlohmann::json::exception&) {
    fail(ResultCode::kFormatInvalid, "a number", "a value that a double can hold", "a larger one");
  }
}

void JsonDocument::fail(ResultCode code, std::string_view member, std::string_view expected, std::string_view found,
                        std::string_view remedy) {
  if (error_) return;
  const auto cut = [](std::string_view text) { return one_line(text); };
  error_ = failure(code, "%s: %s: expected %s, found %s; %s", cut(name_).c_str(), cut(member).c_str(),
                   cut(expected).c_str(), cut(found).c_str(), cut(remedy).c_str())
               .error();
}

void JsonDocument::warn(const std::string& text) { warnings_.push_back(one_line(name_ + ": " + text)); }

JsonObject JsonDocument::message() {
  if (!failed() && !value_.is_object()) {
    fail(ResultCode::kFormatInvalid, "the top", "a JSON object", describe(value_), "is it the right file?");
  }
  return {*this, failed() ? nullptr : &value_, ""};
}

JsonObject JsonDocument::root(std::initializer_list<std::string_view> formats, int version) {
  JsonObject object = message();
  object.choice("format", formats);
  const int number = object.integer("version", {0, 1e9});
  if (!failed() && number != version) {
    fail(ResultCode::kVersionUnsupported, "version", std::to_string(version), std::to_string(number),
         "update beltpick or write the file anew");
  }
  return object;
}

JsonObject::JsonObject(JsonDocument& document, const nlohmann::json* value, std::string path)
    : document_(&document), value_(value), path_(std::move(path)) {}

std::string JsonObject::path(std::string_view member) const {
  return path_.empty() ? std::string(member) : path_ + "." + std::string(member);
}

const nlohmann::json* JsonObject::find(std::string_view member) {
  asked_.emplace_back(member);
  if (value_ == nullptr || document_->failed()) return nullptr;
  const auto at = value_->find(std::string(member));
  return at == value_->end() ? nullptr : &*at;
}

bool JsonObject::has(std::string_view member) { return find(member) != nullptr; }

bool JsonObject::is_object(std::string_view member) {
  const nlohmann::json* value = find(member);
  return value != nullptr && value->is_object();
}

const nlohmann::json* JsonObject::require(std::string_view member, std::string_view expected, bool optional) {
  const nlohmann::json* value = find(member);
  if (value == nullptr && !optional && value_ != nullptr) {
    document_->fail(ResultCode::kMemberMissing, path(member), expected, "no such member", "add it");
  }
  return value;
}

double JsonObject::number(std::string_view member, Between between, std::optional<double> fallback) {
  const std::string expected = range_text("a number", between);
  const nlohmann::json* value = require(member, expected, fallback.has_value());
  if (value == nullptr) return fallback.value_or(std::max(between.low, 0.0));
  if (!value->is_number()) {
    fail(ResultCode::kFormatInvalid, member, expected, describe(*value));
  } else if (!inside(value->get<double>(), between)) {
    fail(ResultCode::kValueOutOfRange, member, expected, describe(*value));
  } else {
    return value->get<double>();
  }
  return fallback.value_or(std::max(between.low, 0.0));
}

int JsonObject::integer(std::string_view member, Between between, std::optional<int> fallback) {
  const std::string expected = range_text("a whole number", between);
  const int harmless = fallback.value_or(static_cast<int>(std::clamp(between.low, 0.0, 1e9)));
  const nlohmann::json* value = require(member, expected, fallback.has_value());
  if (value == nullptr) return harmless;
  if (!value->is_number() || std::floor(value->get<double>()) != value->get<double>()) {
    fail(ResultCode::kFormatInvalid, member, expected, describe(*value));
  } else if (!inside(value->get<double>(), between) || std::abs(value->get<double>()) > 2e9) {
    fail(ResultCode::kValueOutOfRange, member, expected, describe(*value));
  } else {
    return static_cast<int>(value->get<double>());
  }
  return harmless;
}

bool JsonObject::flag(std::string_view member, std::optional<bool> fallback) {
  const nlohmann::json* value = require(member, "true or false", fallback.has_value());
  if (value == nullptr) return fallback.value_or(false);
  if (value->is_boolean()) return value->get<bool>();
  fail(ResultCode::kFormatInvalid, member, "true or false", describe(*value));
  return false;
}

std::string JsonObject::text(std::string_view member, std::optional<std::string> fallback) {
  const nlohmann::json* value = require(member, "a text", fallback.has_value());
  if (value == nullptr) return fallback.value_or("");
  if (value->is_string()) return value->get<std::string>();
  fail(ResultCode::kFormatInvalid, member, "a text", describe(*value));
  return "";
}

int JsonObject::choice(std::string_view member, std::initializer_list<std::string_view> choices,
                       std::optional<int> fallback) {
  std::string expected;
  for (const std::string_view choice : choices) {
    expected += (expected.empty() ? "\"" : ", \"") + std::string(choice) + "\"";
  }
  if (choices.size() > 1) expected = "one of " + expected;
  const nlohmann::json* value = require(member, expected, fallback.has_value());
  if (value == nullptr) return fallback.value_or(0);
  if (value->is_string()) {
    const auto at = std::find(choices.begin(), choices.end(), value->get_ref<const std::string&>());
    if (at != choices.end()) return static_cast<int>(at - choices.begin());
  }
  fail(ResultCode::kValueOutOfRange, member, expected, describe(*value));
  return 0;
}

namespace {

// Appends `columns` finite numbers; false for anything else.
bool read_row(const nlohmann::json& row, int columns, std::vector<double>& out) {
  if (!row.is_array() || row.size() != static_cast<std::size_t>(columns)) return false;
  for (const nlohmann::json& value : row) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return false;
    out.push_back(value.get<double>());
  }
  return true;
}

bool read_matrix(const nlohmann::json& value, int rows, int columns, std::vector<double>& out) {
  return value.is_array() && value.size() == static_cast<std::size_t>(rows) &&
         std::all_of(value.begin(), value.end(), [&](const auto& row) { return read_row(row, columns, out); });
}

std::string matrix_text(int rows, int columns) {
  return std::to_string(rows) + " rows of " + std::to_string(columns) + " numbers";
}

}  // namespace

std::vector<double> JsonObject::numbers(std::string_view member, int rows, int columns) {
  const std::string expected =
      rows == 0 ? "an array of " + std::to_string(columns) + " numbers" : matrix_text(rows, columns);
  std::vector<double> out;
  const nlohmann::json* value = require(member, expected, false);
  const bool good =
      value != nullptr && (rows == 0 ? read_row(*value, columns, out) : read_matrix(*value, rows, columns, out));
  if (!good && value != nullptr) fail(ResultCode::kFormatInvalid, member, expected, describe(*value));
  out.resize(static_cast<std::size_t>(std::max(rows, 1) * columns));
  return out;
}

std::vector<std::vector<double>> JsonObject::matrices(std::string_view member, int rows, int columns) {
  const std::string expected = "an array of matrices of " + matrix_text(rows, columns);
  std::vector<std::vector<double>> out;
  const nlohmann::json* value = require(member, expected, false);
  if (value == nullptr) return out;
  bool good = value->is_array();
  for (std::size_t i = 0; good && i < value->size(); ++i) {
    good = read_matrix((*value)[i], rows, columns, out.emplace_back());
  }
  if (good) return out;
  fail(ResultCode::kFormatInvalid, member, expected, describe(*value));
  return {};
}

JsonObject JsonObject::object(std::string_view member) {
  const nlohmann::json* value = require(member, "an object", false);
  if (value != nullptr && !value->is_object()) {
    fail(ResultCode::kFormatInvalid, member, "an object", describe(*value));
    value = nullptr;
  }
  return {*document_, value, path(member)};
}

std::size_t JsonObject::length(std::string_view member) {
  const nlohmann::json* found = find(member);
  return found != nullptr && found->is_array() ? found->size() : 0;
}

std::vector<double> JsonObject::number_list(std::string_view member, Between between, std::size_t most) {
  const std::string expected = "an array of at most " + std::to_string(most) + " " + range_text("numbers", between);
  const nlohmann::json* value = require(member, expected, true);
  std::vector<double> out;
  if (value == nullptr) return out;
  const bool numbers = value->is_array() && value->size() <= most &&
                       std::all_of(value->begin(), value->end(), [](const auto& v) { return v.is_number(); });
  if (!numbers) {
    fail(ResultCode::kFormatInvalid, member, expected, describe(*value));
    return out;
  }
  for (const nlohmann::json& number : *value) {
    if (!inside(number.get<double>(), between)) {
      fail(ResultCode::kValueOutOfRange, member, expected, describe(number));
      return {};
    }
    out.push_back(number.get<double>());
  }
  return out;
}

std::vector<std::string> JsonObject::texts(std::string_view member) {
  std::vector<std::string> out;
  const nlohmann::json* value = require(member, "an array of texts", false);
  if (value == nullptr) return out;
  const bool good =
      value->is_array() && std::all_of(value->begin(), value->end(), [](const auto& v) { return v.is_string(); });
  if (!good) {
    fail(ResultCode::kFormatInvalid, member, "an array of texts", describe(*value));
    return out;
  }
  for (const nlohmann::json& text : *value) out.push_back(text.get<std::string>());
  return out;
}

std::vector<JsonObject> JsonObject::objects(std::string_view member) {
  std::vector<JsonObject> out;
  const nlohmann::json* value = require(member, "an array of objects", false);
  if (value == nullptr) return out;
  if (!value->is_array()) {
    fail(ResultCode::kFormatInvalid, member, "an array of objects", describe(*value));
    return out;
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    const std::string name = path(member) + "[" + std::to_string(i) + "]";
    if (!(*value)[i].is_object()) {
      document_->fail(ResultCode::kFormatInvalid, name, "an object", describe((*value)[i]));
      return {};
    }
    out.emplace_back(*document_, &(*value)[i], name);
  }
  return out;
}

void JsonObject::finish() {
  if (value_ == nullptr || document_->failed()) return;
  for (const auto& [name, value] : value_->items()) {
    if (std::find(asked_.begin(), asked_.end(), name) == asked_.end()) {
      document_->warn("unknown member '" + path(name) + "' is ignored; check its spelling");
    }
  }
}

}  // namespace beltpick::contract_io
