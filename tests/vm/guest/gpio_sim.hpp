// GpioSim: a simulated GPIO chip of the kernel (gpio-sim) and the far ends of its lines: what an input is pulled to,
// what an output shows, and when, by the kernel's own trace of every output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace vm {

class GpioSim {
 public:
  struct LineName {
    unsigned line;
    const char* name;
  };
  // Makes the chip `label` with lines 0 to lines - 1. `hogged`: a line that the kernel itself holds as "kernel hog", or
  // -1.
  GpioSim(const std::string& label, unsigned lines, const std::vector<LineName>& names = {}, int hogged = -1);
  ~GpioSim();
  GpioSim(const GpioSim&) = delete;
  GpioSim& operator=(const GpioSim&) = delete;

  // The voltages, whatever they mean.
  void pull(unsigned line, bool up) const;
  [[nodiscard]] bool level(unsigned line) const;

  [[nodiscard]] const std::string& chip() const { return chip_; }  // "gpiochip0"
  [[nodiscard]] unsigned first_number() const { return first_number_; }

 private:
  [[nodiscard]] std::filesystem::path line(unsigned number) const;

  std::filesystem::path config_, device_;
  std::string chip_;
  unsigned first_number_ = 0;
};

// One set of an output, as the kernel's tracepoint gpio_value saw it.
struct TracedEdge {
  unsigned line = 0;
  bool high = false;
  std::int64_t at_us = 0;  // on the clock of monotonic_us()
};

// The kernel's record of all outputs of a chip from its construction on.
class OutputTrace {
 public:
  explicit OutputTrace(const GpioSim& sim);
  // What was recorded so far, oldest first; each time only what changed a line.
  [[nodiscard]] std::vector<TracedEdge> read() const;

 private:
  unsigned first_number_;
};

}  // namespace vm
