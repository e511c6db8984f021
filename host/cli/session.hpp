// One run of a command: where its answer, its warnings and its failure go.
#pragma once

#include <string>

#include "base/result.hpp"
#include "contract_io/json_writer.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::cli {

class Session {
 public:
  explicit Session(std::string command) : command_(std::move(command)) {}

  // The flag behind --json.
  bool json = false;

  // The command's answer: `machine` with --json, else `person` (ends with a newline, may be empty).
  void answer(const contract_io::Json& machine, const std::string& person);

  // One line each on stderr.
  void warn(const contract_io::Warnings& warnings) const;

  // "beltpick <command>: <detail> [CODE]" on stderr.
  void fail(const Error& error) const;

 private:
  std::string command_;
};

}  // namespace beltpick::cli
