// Strict reading of a TOML configuration: unknown keys warn, wrong types and values are named with their line.
//
// Values are asked for by dotted key, with their default; an element of an array of tables as "grasp[0].name". The
// first error is kept and told by finish(), so that a configuration is read straight through.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

class TomlConfig {
 public:
  // Errors: kFileNotFound, kFileUnreadable, kFormatInvalid with the line.
  static Result<TomlConfig> read(const std::filesystem::path& path);
  static Result<TomlConfig> parse(std::string_view text, const std::string& name);

  [[nodiscard]] bool has(const std::string& key) const;
  // Elements of the array (of values or of tables) under `key`; 0 where it is not there.
  [[nodiscard]] int count(const std::string& key) const;

  // The value of `key`, or `fallback` where it is not there.
  double number(const std::string& key, double fallback, double low = -std::numeric_limits<double>::max(),
                double high = std::numeric_limits<double>::max());
  int integer(const std::string& key, int fallback, int low = std::numeric_limits<int>::min(),
              int high = std::numeric_limits<int>::max());
  bool flag(const std::string& key, bool fallback);
  std::string text(const std::string& key, const std::string& fallback);
  std::vector<std::string> texts(const std::string& key);
  // `size` numbers, or nothing where the key is not there.
  std::optional<std::vector<double>> numbers(const std::string& key, int size);
  // Makes a missing key an error (kMemberMissing).
  void require(const std::string& key);
  // An error of the caller's own about `key`: "<file>: line n: <key>: expected .., found ..".
  void fail(ResultCode code, const std::string& key, const std::string& expected, const std::string& found);

  // The first error, if any; else warns of keys nobody asked for.
  Result<void> finish(Warnings& warnings);

 private:
  struct Entry {
    std::variant<std::string, std::int64_t, double, bool> value;
    int line = 0;
    bool asked = false;
  };
  friend class TomlFlattener;

  Entry* find(const std::string& key);

  std::string name_;
  std::map<std::string, Entry> entries_;  // by dotted key
  std::map<std::string, int> counts_;     // arrays by dotted key
  std::optional<Error> error_;
};

}  // namespace beltpick::contract_io
