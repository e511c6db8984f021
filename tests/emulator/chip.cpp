#include "emulator/chip.hpp"

extern "C" {
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
}

#include <algorithm>
#include <cstring>
#include <random>
#include <stdexcept>

#include "boot/seal.hpp"
#include "protocol/framing.hpp"

namespace emulator {

namespace {

constexpr std::uint64_t kStartUpCycles = 3'200'000;
constexpr std::uint64_t kCyclesPerByte = 320;  // 500000 baud, ten bits
constexpr std::uint8_t kPaint = 0xA5;

struct PinName {
  char port;
  int bit;
};

struct Board {
  const char* mcu;
  PinName out[5];
  PinName in[4];
};

// As pins.hpp of the boards has them.
constexpr Board kBoards[] = {
    {"atmega2560", {{'L', 3}, {'L', 4}, {'A', 0}, {'A', 1}, {'A', 2}}, {{'L', 1}, {'D', 0}, {'D', 1}, {'B', 4}}},
    {"atmega328p", {{'B', 1}, {'B', 2}, {'D', 5}, {'D', 6}, {'D', 7}}, {{'B', 0}, {'D', 2}, {'D', 3}, {'D', 4}}},
};

void (*reset_of_core)(avr_t*) = nullptr;  // the same for every chip of a kind

const Board& board(Mcu mcu) { return kBoards[static_cast<std::size_t>(mcu)]; }

std::uint16_t load(avr_t* avr, const Board& board, const std::string& elf) {
  elf_firmware_t firmware{};
  if (elf_read_firmware(elf.c_str(), &firmware) != 0) throw std::runtime_error("cannot read " + elf);
  std::strncpy(firmware.mmcu, board.mcu, sizeof firmware.mmcu - 1);
  firmware.frequency = static_cast<std::uint32_t>(kCyclesPerUs * 1'000'000);
  avr_load_firmware(avr, &firmware);
  return beltpick::protocol::crc16(firmware.flash, firmware.flashsize);
}

}  // namespace

Chip::Chip(Mcu mcu, const std::string& elf) : Chip(mcu) {
  flash_crc_ = load(avr_, board(mcu), elf);
  power_up();
}

Chip::Chip(Mcu mcu, const beltpick::boot::FlashImage& flash) : Chip(mcu) {
  for (std::uint32_t at = 0; at <= avr_->flashend; ++at) avr_->flash[at] = flash.byte(at);
  avr_->frequency = static_cast<std::uint32_t>(kCyclesPerUs * 1'000'000);
  avr_->codeend = avr_->flashend;
  const beltpick::boot::ChipLayout& layout = *beltpick::boot::find_chip(std::string(board(mcu).mcu));
  flash_crc_ = beltpick::protocol::crc16(avr_->flash, flash.end(beltpick::boot::firmware_limit(layout)));
  if (flash.has(layout.loader_start)) avr_->reset_pc = avr_->pc = layout.loader_start;
  power_up();
}

Chip::Chip(Mcu mcu) : mcu_(mcu), avr_(avr_make_mcu_by_name(board(mcu).mcu)) {
  if (avr_ == nullptr) throw std::runtime_error(std::string("libsimavr has no ") + board(mcu).mcu);
  avr_init(avr_);
  avr_->log = LOG_NONE;
  avr_->sleep = [](avr_t*, avr_cycle_count_t) {};  // our time passes in cycles, not in seconds
  reset_of_core = avr_->reset;
  avr_->custom.data = this;
  avr_->reset = [](avr_t* avr) {
    reset_of_core(avr);
    static_cast<Chip*>(avr->custom.data)->was_reset();
  };
}

void Chip::power_up() {
  std::fill(avr_->data + 0x200, avr_->data + avr_->ramend + 1, kPaint);
  for (std::size_t i = 0; i < 5; ++i) watch(static_cast<Out>(i), board(mcu_).out[i].port, board(mcu_).out[i].bit);
  connect_line();
  // Until the firmware has set it, an external interrupt is by level; the emulator would then raise it for ever.
  avr_extint_set_strict_lvl_trig(avr_, 0, 0);
  avr_extint_set_strict_lvl_trig(avr_, 1, 0);
  set_pin(In::kStrobe, false);
  set_pin(In::kEmergencyStop, false);
  set_pin(In::kStart, true);
  set_pin(In::kBeltStopped, false);
  run_until(kStartUpCycles);
}

Chip::~Chip() { avr_terminate(avr_); }

std::uint64_t Chip::cycle() const { return avr_->cycle; }

void Chip::watch(Out pin, char port, int bit) {
  Watch& watch = watches_[static_cast<std::size_t>(pin)];
  watch = {this, pin};
  avr_irq_register_notify(
      avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ(port), bit),
      [](avr_irq_t*, std::uint32_t value, void* param) {
        const auto* watched = static_cast<const Watch*>(param);
        watched->chip->note(watched->pin, (value & 0xFFU) != 0);
      },
      &watch);
}

// A pin that the firmware does not drive is low, by the resistor outside. The emulator lets the timer through to it all
// the same, and inverts it when the timer overflows in set or clear mode.
bool Chip::driven(Out pin) const {
  const PinName& name = board(mcu_).out[static_cast<std::size_t>(pin)];
  avr_ioport_state_t state{};
  avr_ioctl(avr_, AVR_IOCTL_IOPORT_GETSTATE(name.port), &state);
  return (state.ddr >> static_cast<unsigned>(name.bit) & 1U) != 0;
}

void Chip::note(Out pin, bool level) {
  level = level && driven(pin);
  bool& known = levels_[static_cast<std::size_t>(pin)];
  if (known == level) return;
  known = level;
  if (on_edge) on_edge({pin, level, avr_->cycle});
}

// The emulator puts an input back to its port's "external" state whenever the firmware writes the port: we say both.
void Chip::set_pin(In pin, bool high) {
  const PinName& name = board(mcu_).in[static_cast<std::size_t>(pin)];
  External& external = externals_[name.port];
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(name.bit));
  external.mask = static_cast<std::uint8_t>(external.mask | bit);
  external.value = static_cast<std::uint8_t>(high ? external.value | bit : external.value & ~bit);
  avr_ioport_external_t state{};
  state.name = static_cast<unsigned char>(name.port) & 0x7FU;
  state.mask = external.mask;
  state.value = external.value;
  avr_ioctl(avr_, AVR_IOCTL_IOPORT_SET_EXTERNAL(name.port), &state);
  avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ(name.port), name.bit), high ? 1 : 0);
}

void Chip::connect_line() {
  std::uint32_t flags = 0;
  avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  line_in_ = avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  avr_irq_register_notify(
      avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
      [](avr_irq_t*, std::uint32_t value, void* param) {
        static_cast<Chip*>(param)->received_.push_back(static_cast<std::uint8_t>(value));
      },
      this);
}

void Chip::send(const std::vector<std::uint8_t>& bytes) {
  to_send_.insert(to_send_.end(), bytes.begin(), bytes.end());
  if (sending_ || to_send_.empty()) return;
  sending_ = true;
  at(cycle() + 1, [this] { next_byte(); });
}

void Chip::next_byte() {
  sending_ = !to_send_.empty();
  if (!sending_) return;
  avr_raise_irq(line_in_, to_send_.front());
  to_send_.pop_front();
  at(cycle() + kCyclesPerByte, [this] { next_byte(); });
}

std::vector<std::uint8_t> Chip::received() {
  std::vector<std::uint8_t> bytes;
  bytes.swap(received_);
  return bytes;
}

void Chip::at(std::uint64_t cycle, std::function<void()> action) {
  actions_.emplace(cycle, std::move(action));
  schedule();
}

// One timer of the emulator stands for the earliest action.
void Chip::schedule() {
  const auto timer = [](avr_t*, avr_cycle_count_t, void* param) -> avr_cycle_count_t {
    static_cast<Chip*>(param)->run_due();
    return 0;
  };
  static constexpr avr_cycle_timer_t kTimer = timer;
  if (actions_.empty()) return;
  const std::uint64_t first = actions_.begin()->first;
  avr_cycle_timer_cancel(avr_, kTimer, this);
  avr_cycle_timer_register(avr_, first > avr_->cycle ? first - avr_->cycle : 0, kTimer, this);
}

void Chip::run_due() {
  while (!actions_.empty() && actions_.begin()->first <= avr_->cycle) {
    const auto action = std::move(actions_.begin()->second);
    actions_.erase(actions_.begin());
    action();
  }
  schedule();
}

void Chip::run_until(std::uint64_t cycle) {
  bool reached = false;
  at(cycle, [&reached] { reached = true; });
  while (!reached) {
    const int state = avr_run(avr_);
    if (state == cpu_Done || state == cpu_Crashed) throw std::runtime_error("the firmware crashed");
    run_due_after_reset();
  }
}

// A reset of the chip forgets the emulator's timers, ours as well.
void Chip::run_due_after_reset() {
  if (actions_.begin()->first <= avr_->cycle) run_due();
}

// Writes "jump to myself" where the main loop stands, once it is not in an interrupt; the reset takes it away.
void Chip::hang() {
  while (avr_->state != cpu_Running || avr_->sreg[S_I] == 0) avr_run(avr_);
  const avr_flashaddr_t at_pc = avr_->pc;
  patch_ = {at_pc, avr_->flash[at_pc], avr_->flash[at_pc + 1]};
  avr_->flash[at_pc] = 0xFF;
  avr_->flash[at_pc + 1] = 0xCF;
}

void Chip::was_reset() {
  ++resets_;
  // The pins float, and the board's pull-downs take them low.
  for (const Watch& watched : watches_) note(watched.pin, false);
  if (!patch_.at) return;
  avr_->flash[*patch_.at] = patch_.low;
  avr_->flash[*patch_.at + 1] = patch_.high;
  patch_.at.reset();
}

void Chip::reset_by_pin() {
  avr_reset(avr_);
  avr_regbit_set(avr_, avr_->reset_flags.extrf);
}

void Chip::brown_out() {
  avr_reset(avr_);
  avr_regbit_set(avr_, avr_->reset_flags.borf);
}

void Chip::power_cycle(std::uint32_t seed) {
  to_send_.clear();
  received_.clear();
  avr_reset(avr_);
  std::minstd_rand chance(seed);
  std::generate(avr_->data + 0x200, avr_->data + avr_->ramend + 1,
                [&] { return static_cast<std::uint8_t>(chance() >> 8U); });
  avr_regbit_set(avr_, avr_->reset_flags.porf);
}

std::uint8_t Chip::flash_byte(std::uint32_t at) const { return avr_->flash[at]; }

std::size_t Chip::stack_bytes() const {
  std::size_t at = avr_->ramend;
  std::size_t untouched = 0;
  while (untouched < 256 && at > 0x200) untouched = avr_->data[at--] == kPaint ? untouched + 1 : 0;
  return avr_->ramend - at - untouched;
}

}  // namespace emulator
