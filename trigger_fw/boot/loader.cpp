// The boot loader: takes a new firmware from avrdude, starts a whole one, and always answers while there is none.
//
// It decides by the cause of the reset. The firmware asked for it: it waits for avrdude. External reset (the PC opened
// the line, or somebody pressed the button): it waits a moment. Else it starts the firmware at once.
// The record goes before the first page of a new firmware comes, so nothing that breaks off half way is ever started.
// No interrupts, no static memory; nothing is ever written at or above its own first byte.
#include <avr/wdt.h>

#include "boot/flash_memory.hpp"
#include "boot/handover.hpp"
#include "boot/line.hpp"
#include "boot/stk500.hpp"
#include "pins.hpp"

namespace beltpick {
namespace boot {
namespace {

constexpr uint16_t kAfterReset_ms = 1000;    // avrdude speaks 0.3 s after it has reset the board
constexpr uint16_t kSession_ms = 10000;      // between two requests
constexpr uint16_t kWithinRequest_ms = 250;  // what has broken off by then does not swallow the next request
constexpr uint8_t kLoaderVersion = 1;

void hold_pins_low() {
  using namespace avr;
  CameraPin::drive();
  ProjectorPin::drive();
  BusyPin::drive();
  DonePin::drive();
  FaultPin::drive();
}

[[noreturn]] void start_firmware() {
  close_line();
  __asm__ volatile("jmp 0");
  __builtin_unreachable();
}

class Loader {
 public:
  // A request whose first byte is there. False when it asked to leave.
  bool serve(uint8_t request) {
    whole_ = true;
    switch (request) {
      case stk500::kGetParameter:
        answer_parameter();
        break;
      case stk500::kSetDevice:
        skip(20);
        confirm();
        break;
      case stk500::kSetDeviceExtended:
        skip(static_cast<uint8_t>(take() - 1U));  // its length comes first, and counts itself
        confirm();
        break;
      case stk500::kLoadAddress:
        load_address();
        break;
      case stk500::kUniversal:
        answer_universal();
        break;
      case stk500::kProgramPage:
        program_page();
        break;
      case stk500::kReadPage:
        read_page();
        break;
      case stk500::kReadSignature:
        if (begin_answer()) {
          for (uint8_t i = 0; i < 3; ++i) send(kChip.signature[i]);
          send(stk500::kOk);
        }
        break;
      case stk500::kLeaveProgramming:
        return !confirm();
      case stk500::kGetSync:
      case stk500::kEnterProgramming:
        confirm();
        break;
      default:
        break;  // what is not known may be the rest of something that broke off
    }
    return true;
  }

 private:
  uint8_t take() {
    uint8_t byte = 0;
    whole_ = whole_ && receive(byte, kWithinRequest_ms);
    return byte;
  }
  void skip(uint8_t count) {
    while (count-- > 0) take();
  }

  // Every parameter is there: the answer may begin.
  bool begin_answer() {
    const bool ended = take() == stk500::kEnd && whole_;
    if (whole_) send(ended ? stk500::kInSync : stk500::kNoSync);
    return ended;
  }
  bool confirm() {
    const bool ended = begin_answer();
    if (ended) send(stk500::kOk);
    return ended;
  }
  void answer(uint8_t value) {
    if (!begin_answer()) return;
    send(value);
    send(stk500::kOk);
  }

  void answer_parameter() {
    const uint8_t parameter = take();
    answer(parameter == stk500::kSoftwareMajor ? kLoaderVersion : 0);
  }

  void load_address() {
    const uint8_t low = take();
    const uint8_t high = take();
    if (!confirm()) return;
    at_ = byte_address(extended_, static_cast<uint16_t>(low | high << 8U));
    addressed_ = true;
  }

  void answer_universal() {
    const uint8_t operation = take();
    skip(1);
    const uint8_t value = take();
    skip(1);
    if (operation == stk500::kUniversalExtendedAddress) extended_ = value;
    answer(0);
  }

  uint16_t take_size() {
    const uint8_t high = take();
    return static_cast<uint16_t>(high << 8U | take());
  }

  void program_page() {
    uint8_t page[kChip.page_bytes];
    const uint16_t size = take_size();
    const bool of_flash = take() == stk500::kMemoryFlash;
    for (uint16_t i = 0; i < size && whole_; ++i) {
      const uint8_t byte = take();
      if (i < kChip.page_bytes) page[i] = byte;
    }
    for (uint16_t i = size; i < kChip.page_bytes; ++i) page[i] = 0xFF;
    if (!begin_answer()) return;
    const bool allowed =
        of_flash && addressed_ && size <= kChip.page_bytes && at_ % kChip.page_bytes == 0 && at_ < kLoaderStart;
    if (allowed) put(page);
    send(allowed ? stk500::kOk : stk500::kFailed);
  }

  void put(const uint8_t* page) {
    if (!record_erased_) erase_page(kFirmwareLimit);
    record_erased_ = at_ != kFirmwareLimit;
    write_page(at_, page);
  }

  void read_page() {
    uint16_t size = take_size();
    take();
    if (!begin_answer()) return;
    for (; size > 0; --size) send(read_flash(at_++));
    send(stk500::kOk);
  }

  // All zero at first: other values would come from initial data, which the loader has not.
  FlashAddress at_ = 0;
  uint8_t extended_ = 0;    // bits 16.. of a word's address
  bool whole_ = true;       // no byte of the request was missing
  bool addressed_ = false;  // since the reset
  bool record_erased_ = false;
};

enum class Entry : uint8_t { kStartAtOnce, kWaitAMoment, kWished };

Entry entry_by(uint8_t cause) {
  const bool wished = (cause & 1U << WDRF) != 0 && loader_wish() == kLoaderWish;
  loader_wish() = 0;
  if (wished) return Entry::kWished;
  return (cause & 1U << EXTRF) != 0 && (cause & 1U << PORF) == 0 ? Entry::kWaitAMoment : Entry::kStartAtOnce;
}

[[noreturn]] __attribute__((noinline)) void run() {
  const uint8_t cause = MCUSR;
  MCUSR = 0;
  wdt_disable();
  hold_pins_low();
  const Entry entry = entry_by(cause);
  // The watchdog that the firmware used to come here has not caught a hang.
  saved_reset_cause() = entry == Entry::kWished ? 1U << EXTRF : cause;
  open_line();
  if (entry == Entry::kStartAtOnce && firmware_is_whole()) start_firmware();
  bool in_session = entry == Entry::kWished;
  uint16_t patience = entry == Entry::kWaitAMoment ? kAfterReset_ms : kSession_ms;
  Loader loader;
  while (true) {
    uint8_t request = 0;
    const bool came = receive(request, patience);
    // The PC that opened the line wants the firmware, not us.
    const bool leave = !came || (!in_session && request != stk500::kGetSync) || !loader.serve(request);
    in_session = true;
    patience = kSession_ms;
    if (leave && firmware_is_whole()) start_firmware();
  }
}

}  // namespace
}  // namespace boot
}  // namespace beltpick

// The first bytes of the section: what the reset vector of the fuses points at. The stack is where the hardware has put
// it, at the end of the RAM.
extern "C" void start_loader() __attribute__((naked, used, externally_visible, section(".vectors")));
extern "C" void start_loader() {
  __asm__ volatile("clr __zero_reg__");
  beltpick::boot::run();
}
