// beltpick flash: gives the trigger microcontroller a firmware, and asks it whether it has arrived.
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "flash/avrdude.hpp"
#include "flash/update.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "temporary_file.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;
using flash::AvrdudeJob;
using flash::Firmware;
using flash::Way;

constexpr const char* kOurLoader = "serial";
constexpr const char* kBoardLoader = "board";

struct FlashCommand {
  std::string file;
  std::string port = "/dev/beltpick-trigger";
  std::string mcu;
  std::string programmer = kOurLoader;
  std::string programmer_port;
  std::string loader;
  bool any = false;
  bool again = false;
  bool dry_run = false;
};

Way way_of(const FlashCommand& command) {
  if (command.programmer == kOurLoader) return Way::kOurLoader;
  return command.programmer == kBoardLoader ? Way::kBoardLoader : Way::kInSystem;
}

// The boot loader's file, for an in-system programmer: as given, or beside the firmware.
Result<std::string> loader_file(const FlashCommand& command, const Firmware& firmware) {
  const std::filesystem::path beside =
      std::filesystem::path(command.file).parent_path() / (std::string("boot_") + firmware.chip->name + ".hex");
  std::string file = command.loader.empty() ? beside.string() : command.loader;
  const auto text = contract_io::read_file(file);
  if (!text) return std::unexpected(text.error());
  boot::FlashImage image;
  const std::string wrong = boot::read_hex(*text, image);
  if (wrong.empty() && image.has(firmware.chip->loader_start)) return file;
  return failure(ResultCode::kFirmwareUnfit,
                 "%s: expected the boot loader of the %s, at %X, found %s; give it with --loader",
                 contract_io::one_line(file).c_str(), firmware.chip->name, unsigned{firmware.chip->loader_start},
                 wrong.empty() ? "another file" : wrong.c_str());
}

Result<AvrdudeJob> job_of(const FlashCommand& command, const Firmware& firmware) {
  AvrdudeJob job;
  job.way = way_of(command);
  job.chip = firmware.chip;
  job.firmware = command.file;
  job.port = command.port;
  if (job.way != Way::kInSystem) return job;
  auto loader = loader_file(command, firmware);
  if (!loader) return std::unexpected(loader.error());
  job.programmer = command.programmer;
  job.programmer_port = command.programmer_port;
  job.loader = std::move(*loader);
  return job;
}

std::string crc_text(std::uint16_t crc) {
  char text[8];
  std::snprintf(text, sizeof text, "%04X", unsigned{crc});
  return text;
}

Json firmware_json(const Firmware& firmware) {
  return {{"file", firmware.file.string()},
          {"mcu", firmware.chip->name},
          {"version", flash::version_text(firmware.record)},
          {"bytes", firmware.record.length},
          {"crc", crc_text(firmware.record.flash_crc)}};
}

Json peer_json(const std::optional<flash::Peer>& peer) {
  if (!peer) return nullptr;
  if (peer->is_loader) return {{"answers", "boot loader"}, {"mcu", peer->chip->name}};
  const protocol::Identity& identity = peer->identity;
  Json json{{"answers", "firmware"},
            {"version", std::to_string(identity.firmware_major) + "." + std::to_string(identity.firmware_minor) + "." +
                            std::to_string(identity.firmware_patch)},
            {"protocol", peer->protocol_version}};
  json["mcu"] = peer->chip != nullptr ? Json(peer->chip->name) : Json(nullptr);
  if (peer->speaks_our_protocol()) json["crc"] = crc_text(identity.flash_crc);
  return json;
}

Result<void> show(const AvrdudeJob& job, const Firmware& firmware, Session& session) {
  const auto words = flash::avrdude_command(job);
  const std::string note =
      firmware.sealed_here ? "# of a copy of the file, with the record that the boot loader asks for\n" : "";
  session.answer({{"firmware", firmware_json(firmware)}, {"dry_run", true}, {"command", words}},
                 note + flash::shell_text(words) + "\n");
  return {};
}

std::string done_text(const Firmware& firmware, const flash::UpdateReport& report, double seconds) {
  char text[200];
  const std::string version = flash::version_text(firmware.record);
  if (!report.changed) {
    std::snprintf(text, sizeof text, "firmware %s (CRC %04X) runs there already; --again flashes it all the same\n",
                  version.c_str(), unsigned{firmware.record.flash_crc});
  } else if (!report.after) {
    std::snprintf(text, sizeof text,
                  "program %s written and read back in %.1f s; nobody answers on its line to confirm it\n",
                  version.c_str(), seconds);
  } else if (!report.after->speaks_our_protocol()) {
    std::snprintf(
        text, sizeof text,
        "firmware %s answers, after %.1f s; its protocol is version %u: a beltpickd of this version needs %u\n",
        version.c_str(), seconds, unsigned{report.after->protocol_version}, unsigned{protocol::kVersion});
  } else {
    std::snprintf(text, sizeof text, "firmware %s (CRC %04X) answers, after %.1f s\n", version.c_str(),
                  unsigned{firmware.record.flash_crc}, seconds);
  }
  return text;
}

Result<flash::UpdateReport> update(const FlashCommand& command, const Firmware& firmware, const AvrdudeJob& job,
                                   Session& session) {
  Progress bar("flash", 100, session.json);
  const flash::Watcher watcher{[&](const std::string& text) {
                                 if (!session.json) std::fprintf(stderr, "beltpick flash: %s\n", text.c_str());
                               },
                               [&](int percent) { bar.show(percent); }};
  const auto line = flash::Line::open(command.port);
  if (job.way == Way::kInSystem) {
    return flash::update_in_system(firmware, job, line ? &*line : nullptr, watcher);
  }
  if (!line) return std::unexpected(line.error());
  return flash::update_over_line(firmware, job, *line, {command.again}, watcher);
}

Result<void> run(const FlashCommand& command, Session& session) {
  const auto firmware = flash::read_firmware(command.file, command.mcu, command.any);
  if (!firmware) return std::unexpected(firmware.error());
  auto job = job_of(command, *firmware);
  if (!job) return std::unexpected(job.error());
  if (command.dry_run) return show(*job, *firmware, session);
  if (auto found = flash::find_avrdude(); !found) return std::unexpected(found.error());
  std::optional<TemporaryFile> sealed;
  if (firmware->sealed_here) {
    auto made = TemporaryFile::make(".hex", boot::hex_text(firmware->image));
    if (!made) return std::unexpected(made.error());
    job->firmware = sealed.emplace(std::move(*made)).path();
  }
  const Stopwatch watch;
  const auto report = update(command, *firmware, *job, session);
  if (!report) return std::unexpected(report.error());
  const double seconds = watch.elapsed_ms() / 1000.0;
  session.answer({{"firmware", firmware_json(*firmware)},
                  {"before", peer_json(report->before)},
                  {"after", peer_json(report->after)},
                  {"changed", report->changed},
                  {"avrdude_runs", report->runs},
                  {"seconds", seconds}},
                 done_text(*firmware, *report, seconds));
  return {};
}

}  // namespace

Run add_flash(CLI::App& app) {
  const auto command = std::make_shared<FlashCommand>();
  app.add_option("firmware", command->file, "the firmware's .hex")->required()->type_name("FILE");
  app.add_option("--port", command->port, "the trigger box's tty (default " + command->port + ")")->type_name("TTY");
  app.add_option("--mcu", command->mcu, "refuse a firmware for another one: atmega2560, atmega328p")
      ->check(CLI::IsMember({"atmega2560", "atmega328p"}))
      ->type_name("NAME");
  app.add_option(
         "--programmer", command->programmer,
         "serial: beltpick's boot loader (default); board: the one that an Arduino came with; or avrdude's name "
         "of an in-system programmer (usbasp, avrispmkII ...), which sets fuses, boot loader and firmware")
      ->type_name("NAME");
  app.add_option("--programmer-port", command->programmer_port, "where the in-system programmer is (default: on USB)")
      ->type_name("PORT");
  app.add_option("--loader", command->loader,
                 "the boot loader's .hex, for an in-system programmer (default: boot_<mcu>.hex beside the firmware)")
      ->type_name("FILE");
  app.add_flag("--any", command->any, "also a program that is none of beltpick's; needs --mcu");
  app.add_flag("--again", command->again, "even if this firmware runs there already");
  app.add_flag("--dry-run", command->dry_run, "only print the avrdude command");
  example(app,
          "  beltpick flash trigger_atmega2560.hex --port /dev/beltpick-trigger\n"
          "  beltpick flash trigger_atmega328p.hex --programmer board      # an Arduino's first time\n"
          "  beltpick flash trigger_atmega2560.hex --programmer usbasp --dry-run\n"
          "A running beltpickd holds the line: sudo systemctl stop beltpickd, and start it afterwards.\n"
          "An update that broke off leaves the boot loader answering: run it again.");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
