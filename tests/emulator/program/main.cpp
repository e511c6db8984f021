// trigger_emulator: the trigger box without hardware: the firmware's real ELF under libsimavr in real time, its serial
// line on a pseudo-terminal, its pins on a socket of the process that started it (host/pin_link.hpp).
#include <getopt.h>
#include <poll.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "chip_of_files.hpp"
#include "emulator/live_chip.hpp"
#include "emulator/pin_wires.hpp"

namespace {

constexpr const char* kUsage =
    "trigger_emulator --elf FILE | --flash FILE... [--line LINK] [--pins FD]\n"
    "  --elf FILE   the firmware as it would be flashed: trigger_atmega2560.elf or trigger_atmega328p.elf\n"
    "  --flash FILE instead: a .hex of what is in the flash, repeated for firmware and boot loader: beltpick flash\n"
    "               can then give it another firmware\n"
    "  --line LINK  where a link to the serial line's tty is made; without it the tty's name is printed\n"
    "  --pins FD    an open SOCK_SEQPACKET socket to the cell; without it the belt stands and no camera answers\n"
    "Runs until SIGTERM, or until the cell hangs up.\n"
    "  trigger_emulator --elf build/fw/bin/trigger_atmega2560.elf --line /tmp/trigger\n";

volatile std::sig_atomic_t stop_wanted = 0;
void want_stop(int) { stop_wanted = 1; }

struct Options {
  std::string elf, line;
  std::vector<std::string> flash;
  int pins = -1;
};

[[noreturn]] void refuse(const std::string& what) {
  std::fprintf(stderr, "trigger_emulator: %s; see --help\n", what.c_str());
  std::exit(2);
}

int descriptor(const char* text) {
  char* end = nullptr;
  const long number = std::strtol(text, &end, 10);
  if (end == text || *end != '\0' || number < 0 || number > 1'000'000) {
    refuse(std::string("--pins: expected the number of an open socket, found '") + text + "'");
  }
  return static_cast<int>(number);
}

Options parse(int argc, char** argv) {
  static constexpr option kLong[] = {
      {"elf", required_argument, nullptr, 'e'},  {"flash", required_argument, nullptr, 'f'},
      {"line", required_argument, nullptr, 'l'}, {"pins", required_argument, nullptr, 'p'},
      {"help", no_argument, nullptr, 'h'},       {}};
  Options options;
  for (int given = 0; (given = getopt_long(argc, argv, "h", kLong, nullptr)) != -1;) {
    if (given == 'h') {
      std::fputs(kUsage, stdout);
      std::exit(0);
    }
    if (given == '?') std::exit(2);
    if (given == 'e') options.elf = optarg;
    if (given == 'f') options.flash.emplace_back(optarg);
    if (given == 'l') options.line = optarg;
    if (given == 'p') options.pins = descriptor(optarg);
  }
  if (optind < argc) refuse(std::string("unexpected '") + argv[optind] + "'");
  if (options.elf.empty() == options.flash.empty()) refuse("expected either --elf or --flash");
  return options;
}

// `link`: to the cell; null where nobody is at the pins. `started` once the cell knows that the board runs.
void run(const Options& options, beltpick::host::PinLink* link, bool& started) {
  const std::unique_ptr<emulator::Chip> chip = emulator::make_chip(options.elf, options.flash);
  emulator::LiveChip live(*chip, options.line);
  std::unique_ptr<emulator::PinWires> wires;
  if (link != nullptr) wires = std::make_unique<emulator::PinWires>(*chip, live, *link);
  started = true;
  if (options.line.empty()) {
    std::printf("%s\n", live.tty().c_str());
    std::fflush(stdout);
  }
  pollfd waits[] = {{live.line_fd(), POLLIN, 0}, {options.pins, POLLIN, 0}};
  while (stop_wanted == 0 && (wires == nullptr || wires->serve())) {
    live.turn();
    ::poll(waits, 2, static_cast<int>(emulator::LiveChip::kStep.count()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::signal(SIGTERM, want_stop);
  // At ctrl-C the cell ends us, after itself.
  std::signal(SIGINT, options.pins >= 0 ? SIG_IGN : want_stop);
  std::unique_ptr<beltpick::host::PinLink> link;
  if (options.pins >= 0) link = std::make_unique<beltpick::host::PinLink>(options.pins);
  bool started = false;
  try {
    run(options, link.get(), started);
  } catch (const std::exception& error) {
    if (link != nullptr && !started) {
      link->send_failure(error.what());
    } else {
      std::fprintf(stderr, "trigger_emulator: %s\n", error.what());
    }
    return 1;
  }
  return 0;
}
