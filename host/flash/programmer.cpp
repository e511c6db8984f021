#include "flash/programmer.hpp"

#include <cstdio>

namespace beltpick::flash {

namespace {

std::string fuse(const char* name, unsigned value) {
  char text[32];
  std::snprintf(text, sizeof text, "%s:w:0x%02X:m", name, value);
  return text;
}

// Fuses, then an erased flash with both programs, and the lock last: the erasure takes it away. A new chip runs at
// 1 MHz until its fuses name the crystal: 8 us a bit are slow enough for it.
void add_in_system(const AvrdudeJob& job, std::vector<std::string>& command) {
  command.insert(command.end(), {"-c", job.programmer});
  if (!job.programmer_port.empty()) command.insert(command.end(), {"-P", job.programmer_port});
  command.insert(command.end(), {"-B", "8", "-e"});
  for (const std::string& write :
       {fuse("lfuse", job.chip->low_fuse), fuse("hfuse", job.chip->high_fuse), fuse("efuse", job.chip->extended_fuse),
        "flash:w:" + job.loader + ":i", "flash:w:" + job.firmware + ":i", fuse("lock", job.chip->lock)}) {
    command.insert(command.end(), {"-U", write});
  }
}

void add_serial(const AvrdudeJob& job, const char* protocol, const char* baud, std::vector<std::string>& command) {
  command.insert(command.end(),
                 {"-c", protocol, "-P", job.port, "-b", baud, "-D", "-U", "flash:w:" + job.firmware + ":i"});
}

}  // namespace

std::vector<std::string> avrdude_command(const AvrdudeJob& job) {
  std::vector<std::string> command = {"avrdude", "-p", job.chip->name};
  switch (job.way) {
    case Way::kOurLoader:
      add_serial(job, "arduino", "500000", command);
      break;
    case Way::kBoardLoader:
      add_serial(job, job.chip->board == protocol::BoardKind::kAtmega2560 ? "wiring" : "arduino", "115200", command);
      break;
    case Way::kInSystem:
      add_in_system(job, command);
      break;
  }
  return command;
}

std::string shell_text(const std::vector<std::string>& command) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@";
  std::string text;
  for (const std::string& word : command) {
    if (!text.empty()) text += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) c == '\'' ? text += "'\\''" : text += c;
    text += '\'';
  }
  return text;
}

}  // namespace beltpick::flash
