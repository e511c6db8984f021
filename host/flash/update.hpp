// One field update: from whoever answers on the line to the new firmware, identified. What breaks off on the way is
// tried again; the boot loader waits for it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "flash/firmware_file.hpp"
#include "flash/line.hpp"
#include "flash/peer.hpp"
#include "flash/programmer.hpp"

namespace beltpick::flash {

// For the person who waits.
struct Watcher {
  std::function<void(const std::string&)> say;  // a line on what was found or is done
  std::function<void(int)> percent;
};

struct UpdateReport {
  std::optional<Peer> before;  // nothing where nobody answered
  std::optional<Peer> after;   // the firmware that runs now; nothing where it could not be asked
  bool changed = true;         // false: this firmware was there already
  int runs = 0;                // of avrdude
};

struct UpdateOptions {
  bool again = false;  // flash even what is there already
  int tries = 3;
};

// Over the serial line (job.way is kOurLoader or kBoardLoader). Errors: kTriggerLost where nobody answers, kDeviceInUse
// while a sequence runs, kFirmwareUnfit for another board or one without our loader, kUpdateFailed after all tries.
Result<UpdateReport> update_over_line(const Firmware& firmware, const AvrdudeJob& job, const Line& line,
                                      const UpdateOptions& options, const Watcher& watcher);

// With an in-system programmer. `line`: where the new firmware is asked afterwards, or null. Error: kUpdateFailed.
Result<UpdateReport> update_in_system(const Firmware& firmware, const AvrdudeJob& job, const Line* line,
                                      const Watcher& watcher);

// "firmware 0.1.0", "boot loader", "a firmware of protocol version 3, 0.4.0"
std::string peer_text(const Peer& peer);

}  // namespace beltpick::flash
