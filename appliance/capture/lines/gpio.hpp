// Gpio: digital lines of this PC in five functions: request, read, write, and the edges of an input with the kernel's
// time stamps. Behind it is libgpiod: gpio_v1.cpp for version 1, gpio_v2.cpp for version 2; CMake compiles the one that
// is there. A requested line belongs to this process until it is destroyed or the process ends.
//
// Levels are logical: active is what the line means, whichever voltage that is.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "base/result.hpp"
#include "capture/lines/line_spec.hpp"

namespace beltpick::capture {

enum class LineUse : std::uint8_t { kInput, kOutput };

struct LineEdge {
  bool active = false;     // level after the edge
  std::int64_t at_us = 0;  // the kernel's stamp, on the clock of monotonic_us()
};

// One requested line. None of its functions allocates or blocks.
class GpioLine {
 public:
  virtual ~GpioLine() = default;

  // Errors of all: kLinesLost, with the line's name: its chip was taken away.
  [[nodiscard]] virtual Result<bool> read() = 0;
  // Of an output.
  [[nodiscard]] virtual Result<void> write(bool active) = 0;
  // The next edge of an input, oldest first; nothing while there is none.
  [[nodiscard]] virtual Result<std::optional<LineEdge>> next_edge() = 0;
  // For poll(): readable while there are edges of an input.
  [[nodiscard]] virtual int edge_fd() const = 0;
};

class Gpio {
 public:
  virtual ~Gpio() = default;

  // Takes a line: an input with both edges watched, an output inactive. `name` is what it is to us ("belt_stopped"): it
  // stands in error messages, and other programs see it as the line's consumer. Errors: kLineNotFound where chip or
  // line are not there or may not be opened; kLineInUse, with whose it is.
  [[nodiscard]] virtual Result<std::unique_ptr<GpioLine>> request(const LineSpec& spec, LineUse use,
                                                                  const char* name) = 0;
};

// request() where the line is wired; leaves `line` null where it is not.
Result<void> request_wired(Gpio& gpio, const LineSpec& spec, LineUse use, const char* name,
                           std::unique_ptr<GpioLine>& line);

// The lines of this PC, and the version of libgpiod that serves them.
Gpio& gpio_of_this_pc();
const char* gpio_library_version();

}  // namespace beltpick::capture
