// Chip: a microcontroller of libsimavr that runs the firmware's real ELF. Its time is its own clock cycle (16 MHz) and
// passes only in run_until(); inputs change and outputs are recorded to the cycle.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "boot/flash_image.hpp"

struct avr_t;
struct avr_irq_t;

namespace emulator {

inline constexpr std::uint64_t kCyclesPerUs = 16;

enum class Mcu : std::uint8_t { kAtmega2560, kAtmega328p };

enum class Out : std::uint8_t { kCamera, kProjector, kBusy, kDone, kFault };
enum class In : std::uint8_t { kStrobe, kEmergencyStop, kStart, kBeltStopped };

struct PinEdge {
  Out pin;
  bool level;
  std::uint64_t cycle;
};

class Chip {
 public:
  // Powers the board up with the program of an ELF file, its belt standing and the emergency stop released, and lets it
  // start (0.2 s of its time). Throws std::runtime_error where libsimavr does not know the chip or cannot read the
  // file.
  Chip(Mcu mcu, const std::string& elf);
  // The same of a board whose flash holds this; with a boot loader in it, it starts there, as its fuses would have it.
  Chip(Mcu mcu, const beltpick::boot::FlashImage& flash);
  ~Chip();
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  [[nodiscard]] std::uint64_t cycle() const;
  void run_until(std::uint64_t cycle);
  void run_us(std::uint64_t us) { run_until(cycle() + us * kCyclesPerUs); }
  // Calls `action` at that cycle, while it runs.
  void at(std::uint64_t cycle, std::function<void()> action);

  // `high`: the level of the pin.
  void set_pin(In pin, bool high);
  [[nodiscard]] bool level(Out pin) const { return levels_[static_cast<std::size_t>(pin)]; }
  // Called for each edge of an output as it happens.
  std::function<void(const PinEdge&)> on_edge;

  // Bytes for the serial line, at its speed; and what the firmware sent since the last call.
  void send(const std::vector<std::uint8_t>& bytes);
  std::vector<std::uint8_t> received();

  // The main loop stands still for ever from now on; interrupts still come. The next reset finds it whole again.
  void hang();
  [[nodiscard]] int resets() const { return resets_; }
  // The reset pin falls and rises, as a serial line's DTR makes it.
  void reset_by_pin();
  // The supply falls below the brown-out's threshold and comes back: a reset, the RAM as it was.
  void brown_out();
  // The power goes and comes: the flash keeps what it has, the RAM holds chance (of this seed), the line nothing.
  void power_cycle(std::uint32_t seed);
  // CRC-16 over the program as it was loaded.
  [[nodiscard]] std::uint16_t flash_crc() const { return flash_crc_; }
  [[nodiscard]] std::uint8_t flash_byte(std::uint32_t at) const;
  // RAM that the stack has used at most.
  [[nodiscard]] std::size_t stack_bytes() const;

 private:
  struct Watch {
    Chip* chip = nullptr;
    Out pin = Out::kCamera;
  };

  explicit Chip(Mcu mcu);
  void power_up();
  void watch(Out pin, char port, int bit);
  void connect_line();
  void next_byte();
  void schedule();
  void run_due();
  void run_due_after_reset();
  void was_reset();
  [[nodiscard]] bool driven(Out pin) const;
  void note(Out pin, bool level);

  Mcu mcu_;
  avr_t* avr_ = nullptr;
  std::multimap<std::uint64_t, std::function<void()>> actions_;
  Watch watches_[5];
  bool levels_[5] = {};
  avr_irq_t* line_in_ = nullptr;
  std::deque<std::uint8_t> to_send_;
  bool sending_ = false;
  std::vector<std::uint8_t> received_;
  struct External {
    std::uint8_t mask = 0;
    std::uint8_t value = 0;
  };
  std::map<char, External> externals_;
  struct Patch {
    std::optional<std::uint32_t> at;
    std::uint8_t low = 0;
    std::uint8_t high = 0;
  } patch_;
  int resets_ = 0;
  std::uint16_t flash_crc_ = 0;
};

}  // namespace emulator
