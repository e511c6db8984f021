#include "contract_io/toml_config.hpp"

#include <toml++/toml.h>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::contract_io {
namespace {

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string range_text(const std::string& what, double low, double high) {
  return what + " between " + number_text(low) + " and " + number_text(high);
}

template <class Value>
std::string describe(const Value& value) {
  struct Describe {
    std::string operator()(const std::string& text) const { return "\"" + text.substr(0, 48) + "\""; }
    std::string operator()(std::int64_t number) const { return std::to_string(number); }
    std::string operator()(double number) const { return number_text(number); }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
  };
  return std::visit(Describe{}, value);
}

}  // namespace

// Walks the parsed tree and files every value under its dotted key.
class TomlFlattener {
 public:
  explicit TomlFlattener(TomlConfig& config) : config_(config) {}

  void table(const toml::table& table, const std::string& prefix) {
    for (const auto& [key, node] : table) {
      const std::string name(key.str());
      file(node, prefix.empty() ? name : prefix + "." + name);
    }
  }

 private:
  void file(const toml::node& node, const std::string& key) {
    if (const auto* inner = node.as_table()) {
      table(*inner, key);
    } else if (const auto* array = node.as_array()) {
      config_.counts_[key] = static_cast<int>(array->size());
      for (std::size_t i = 0; i < array->size(); ++i) file((*array)[i], key + "[" + std::to_string(i) + "]");
    } else {
      value(node, key);
    }
  }

  void value(const toml::node& node, const std::string& key) {
    TomlConfig::Entry entry;
    entry.line = static_cast<int>(node.source().begin.line);
    if (const auto* text = node.as_string()) entry.value = text->get();
    if (const auto* whole = node.as_integer()) entry.value = whole->get();
    if (const auto* real = node.as_floating_point()) entry.value = real->get();
    if (const auto* flag = node.as_boolean()) entry.value = flag->get();
    if (node.is_date() || node.is_time() || node.is_date_time()) entry.value = std::string("a date");
    config_.entries_[key] = entry;
  }

  TomlConfig& config_;
};

Result<TomlConfig> TomlConfig::parse(std::string_view text, const std::string& name) {
  TomlConfig config;
  config.name_ = name;
  try {
    TomlFlattener(config).table(toml::parse(text, name), "");
  } catch (const toml::parse_error& error) {
    return failure(ResultCode::kFormatInvalid, "%s: line %u: expected TOML, found: %s; correct this line", name.c_str(),
                   error.source().begin.line, one_line(error.description()).c_str());
  }
  return config;
}

Result<TomlConfig> TomlConfig::read(const std::filesystem::path& path) {
  const auto text = read_file(path, std::size_t{16} << 20U);
  if (!text) return std::unexpected(text.error());
  return parse(*text, one_line(path.string()));
}

bool TomlConfig::has(const std::string& key) const { return entries_.contains(key) || counts_.contains(key); }

int TomlConfig::count(const std::string& key) const {
  const auto at = counts_.find(key);
  return at == counts_.end() ? 0 : at->second;
}

TomlConfig::Entry* TomlConfig::find(const std::string& key) {
  const auto at = entries_.find(key);
  if (at == entries_.end()) {
    if (counts_.contains(key)) fail(ResultCode::kFormatInvalid, key, "a single value", "an array");
    return nullptr;
  }
  at->second.asked = true;
  return &at->second;
}

void TomlConfig::fail(ResultCode code, const std::string& key, const std::string& expected, const std::string& found) {
  if (error_) return;
  const auto at = entries_.find(key);
  const std::string line = at == entries_.end() ? "" : "line " + std::to_string(at->second.line) + ": ";
  error_ = failure(code, "%s: %s%s: expected %s, found %s; correct this value", name_.c_str(), line.c_str(),
                   one_line(key).c_str(), one_line(expected).c_str(), one_line(found).c_str())
               .error();
}

double TomlConfig::number(const std::string& key, double fallback, double low, double high) {
  const Entry* entry = find(key);
  if (entry == nullptr) return fallback;
  const auto* whole = std::get_if<std::int64_t>(&entry->value);
  const auto* real = std::get_if<double>(&entry->value);
  if (whole == nullptr && real == nullptr) {
    fail(ResultCode::kFormatInvalid, key, "a number", describe(entry->value));
    return fallback;
  }
  const double value = whole != nullptr ? static_cast<double>(*whole) : *real;
  if (value >= low && value <= high) return value;  // a NaN is outside
  fail(ResultCode::kValueOutOfRange, key, range_text("a number", low, high), describe(entry->value));
  return fallback;
}

int TomlConfig::integer(const std::string& key, int fallback, int low, int high) {
  const Entry* entry = find(key);
  if (entry == nullptr) return fallback;
  const auto* whole = std::get_if<std::int64_t>(&entry->value);
  if (whole == nullptr) {
    fail(ResultCode::kFormatInvalid, key, "a whole number", describe(entry->value));
  } else if (*whole < low || *whole > high) {
    fail(ResultCode::kValueOutOfRange, key, range_text("a whole number", low, high), describe(entry->value));
  } else {
    return static_cast<int>(*whole);
  }
  return fallback;
}

bool TomlConfig::flag(const std::string& key, bool fallback) {
  const Entry* entry = find(key);
  if (entry == nullptr) return fallback;
  if (const auto* flag = std::get_if<bool>(&entry->value)) return *flag;
  fail(ResultCode::kFormatInvalid, key, "true or false", describe(entry->value));
  return fallback;
}

std::string TomlConfig::text(const std::string& key, const std::string& fallback) {
  const Entry* entry = find(key);
  if (entry == nullptr) return fallback;
  if (const auto* text = std::get_if<std::string>(&entry->value)) return *text;
  fail(ResultCode::kFormatInvalid, key, "a text in quotes", describe(entry->value));
  return fallback;
}

std::vector<std::string> TomlConfig::texts(const std::string& key) {
  std::vector<std::string> out;
  if (entries_.contains(key)) {
    fail(ResultCode::kFormatInvalid, key, "an array of texts", describe(find(key)->value));
    return out;
  }
  for (int i = 0; i < count(key); ++i) out.push_back(text(key + "[" + std::to_string(i) + "]", ""));
  return out;
}

std::optional<std::vector<double>> TomlConfig::numbers(const std::string& key, int size) {
  if (!has(key)) return std::nullopt;
  const std::string expected = "an array of " + std::to_string(size) + " numbers";
  if (entries_.contains(key)) {
    fail(ResultCode::kFormatInvalid, key, expected, describe(find(key)->value));
  } else if (count(key) != size) {
    fail(ResultCode::kFormatInvalid, key, expected, std::to_string(count(key)));
  }
  std::vector<double> out;
  for (int i = 0; i < size; ++i) out.push_back(number(key + "[" + std::to_string(i) + "]", 0.0));
  return out;
}

void TomlConfig::require(const std::string& key) {
  if (!has(key)) fail(ResultCode::kMemberMissing, key, "this key", "none");
}

Result<void> TomlConfig::finish(Warnings& warnings) {
  if (error_) return std::unexpected(*error_);
  for (const auto& [key, entry] : entries_) {
    if (entry.asked) continue;
    warnings.push_back(name_ + ": line " + std::to_string(entry.line) + ": unknown key '" + one_line(key) +
                       "' is ignored; check its spelling");
  }
  return {};
}

}  // namespace beltpick::contract_io
