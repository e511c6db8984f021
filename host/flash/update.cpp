#include "flash/update.hpp"

#include "contract/result_codes.hpp"
#include "flash/avrdude.hpp"

namespace beltpick::flash {

namespace {

constexpr int kFindMs = 6000;   // a board that resets when it is opened, with a slow loader of its own
constexpr int kEnterMs = 3000;  // from the firmware to its loader
constexpr int kStartMs = 6000;  // from the loader to the new firmware

bool is_version(const Peer& peer, const Firmware& firmware) {
  const protocol::Identity& found = peer.identity;
  const boot::Record& wanted = firmware.record;
  return firmware.sealed_here || (found.firmware_major == wanted.major && found.firmware_minor == wanted.minor &&
                                  found.firmware_patch == wanted.patch);
}

bool is_this(const Peer& peer, const Firmware& firmware) {
  return !peer.is_loader && peer.chip == firmware.chip && is_version(peer, firmware) && peer.speaks_our_protocol() &&
         peer.identity.flash_crc == firmware.record.flash_crc &&
         peer.identity.flash_state != protocol::FlashState::kDamaged;
}

// After avrdude has written the flash and read it back. A firmware of another version of the protocol cannot be asked
// for its CRC: its version must do; the loader would not have started it damaged.
// A program of somebody else's need not answer at all.
bool has_arrived(const std::optional<Peer>& peer, const Firmware& firmware) {
  if (!peer) return firmware.sealed_here;
  return is_this(*peer, firmware) || (!peer->is_loader && !peer->speaks_our_protocol() && peer->chip == firmware.chip &&
                                      is_version(*peer, firmware));
}

class LineUpdate {
 public:
  LineUpdate(const Firmware& firmware, const AvrdudeJob& job, const Line& line, const UpdateOptions& options,
             const Watcher& watcher)
      : firmware_(firmware), job_(job), line_(line), options_(options), watcher_(watcher) {}

  Result<UpdateReport> run() {
    report_.before = find_anyone();
    if (auto judged = judge(); !judged) return std::unexpected(judged.error());
    if (report_.before && !options_.again && is_this(*report_.before, firmware_)) {
      report_.after = report_.before;
      report_.changed = false;
      return report_;
    }
    std::optional<Peer> peer = report_.before;
    while (true) {
      if (auto entered = enter_loader(peer); !entered) return std::unexpected(entered.error());
      ++report_.runs;
      const Result<void> written = run_avrdude(job_, watcher_.percent);
      if (!written && written.error().code != ResultCode::kUpdateFailed) return std::unexpected(written.error());
      peer = written ? find_started() : find_peer(line_, kFindMs);
      if (written ? has_arrived(peer, firmware_) : peer && is_this(*peer, firmware_)) {
        report_.after = peer;
        return report_;
      }
      const std::string cause = written ? "what arrived is not the firmware that was sent" : written.error().detail;
      if (auto again = may_try_again(cause, peer); !again) return std::unexpected(again.error());
    }
  }

 private:
  // A program that hangs, or does not speak, still has our loader below it: a reset brings it out.
  std::optional<Peer> find_anyone() {
    if (auto peer = find_peer(line_, kFindMs)) return peer;
    if (job_.way == Way::kBoardLoader) return std::nullopt;
    line_.reset_board();
    return find_loader(line_, kEnterMs);
  }

  // A firmware that starts; or the loader, where it found nothing whole to start.
  std::optional<Peer> find_started() {
    auto firmware = find_firmware(line_, kStartMs / 2);
    return firmware ? firmware : find_peer(line_, kStartMs / 2);
  }

  Result<void> judge() {
    const char* port = line_.port().c_str();
    if (!report_.before) {
      if (job_.way == Way::kBoardLoader) return {};
      return failure(ResultCode::kTriggerLost,
                     "%s: expected the trigger box's firmware or boot loader, found that nobody answers; check cable "
                     "and power; a board's first firmware needs --programmer board or an in-system programmer",
                     port);
    }
    watcher_.say(line_.port() + ": " + peer_text(*report_.before) + " answers");
    if (report_.before->chip == firmware_.chip) return {};
    if (report_.before->chip == nullptr) {
      return failure(ResultCode::kFirmwareUnfit,
                     "%s: expected a microcontroller, found a virtual cell's stand-in, which has no flash", port);
    }
    return failure(ResultCode::kFirmwareUnfit,
                   "%s: expected a board with the %s of the firmware, found one with the %s; give trigger_%s.hex", port,
                   firmware_.chip->name, report_.before->chip->name, report_.before->chip->name);
  }

  // Where the firmware runs; the loader of the board is entered by avrdude's reset.
  Result<void> enter_loader(const std::optional<Peer>& peer) {
    if (job_.way == Way::kBoardLoader || !peer || peer->is_loader) return {};
    const auto refusal = ask_for_loader(line_, *peer);
    const char* port = line_.port().c_str();
    if (refusal == protocol::Refusal::kSequenceRunning) {
      return failure(ResultCode::kDeviceInUse,
                     "%s: expected the trigger box to stand idle, found a sequence running; stop the cell first", port);
    }
    if (refusal && *refusal != protocol::Refusal::kNone) {
      return failure(ResultCode::kFirmwareUnfit,
                     "%s: expected the firmware to start its boot loader, found that it refuses: %s; use --programmer "
                     "board or an in-system programmer",
                     port, protocol::refusal_text(*refusal));
    }
    if (find_loader(line_, kEnterMs)) return {};
    if (!find_firmware(line_, kStartMs)) {
      return failure(ResultCode::kTriggerLost,
                     "%s: expected the boot loader, found that nobody answers any more; check cable and power", port);
    }
    return failure(ResultCode::kFirmwareUnfit,
                   "%s: expected the boot loader, found the firmware again: this board has no boot loader of "
                   "beltpick's; use --programmer board, or give it one by an in-system programmer",
                   port);
  }

  Result<void> may_try_again(const std::string& cause, const std::optional<Peer>& peer) {
    const std::string found = peer ? peer_text(*peer) + " answers" : "nobody answers";
    if (peer && report_.runs < options_.tries) {
      watcher_.say(cause + "; " + found + ": once more");
      return {};
    }
    const char* remedy =
        peer ? "run it again" : "check cable and power, then run it again: the boot loader waits for it";
    return failure(ResultCode::kUpdateFailed, "%s: expected the new firmware, found: %s; %s; %s", line_.port().c_str(),
                   cause.c_str(), found.c_str(), remedy);
  }

  const Firmware& firmware_;
  const AvrdudeJob& job_;
  const Line& line_;
  const UpdateOptions& options_;
  const Watcher& watcher_;
  UpdateReport report_;
};

}  // namespace

std::string peer_text(const Peer& peer) {
  if (peer.is_loader) return "the boot loader";
  const protocol::Identity& identity = peer.identity;
  std::string text = "firmware " + std::to_string(identity.firmware_major) + "." +
                     std::to_string(identity.firmware_minor) + "." + std::to_string(identity.firmware_patch);
  if (!peer.speaks_our_protocol()) {
    text += " (protocol version " + std::to_string(peer.protocol_version) + ")";
  }
  return text;
}

Result<UpdateReport> update_over_line(const Firmware& firmware, const AvrdudeJob& job, const Line& line,
                                      const UpdateOptions& options, const Watcher& watcher) {
  return LineUpdate(firmware, job, line, options, watcher).run();
}

Result<UpdateReport> update_in_system(const Firmware& firmware, const AvrdudeJob& job, const Line* line,
                                      const Watcher& watcher) {
  UpdateReport report;
  report.runs = 1;
  if (auto written = run_avrdude(job, watcher.percent); !written) {
    return std::unexpected(written.error());
  }
  if (line == nullptr) return report;
  report.after = find_firmware(*line, kStartMs);
  if (has_arrived(report.after, firmware)) return report;
  return failure(ResultCode::kUpdateFailed,
                 "%s: expected the new firmware to answer, found %s; check the line and the board",
                 line->port().c_str(), report.after ? peer_text(*report.after).c_str() : "that nobody answers");
}

}  // namespace beltpick::flash
