#include "capture/lines/gpio_errors.hpp"

#include <cerrno>
#include <cstring>

#include "contract/result_codes.hpp"

namespace beltpick::capture {

std::unexpected<Error> no_chip(const LineSpec& spec, const char* name, int number) {
  if (number == EACCES || number == EPERM) {
    return failure(ResultCode::kLineNotFound,
                   "lines.%s: GPIO chip '%s': expected to open it, found no permission; run as an account of the group "
                   "that /dev/gpiochip* belong to",
                   name, spec.chip.c_str());
  }
  return failure(ResultCode::kLineNotFound,
                 "lines.%s: expected GPIO chip '%s', found none (%s); gpiodetect lists those of this PC", name,
                 spec.chip.c_str(), std::strerror(number));
}

std::unexpected<Error> no_line(const LineSpec& spec, const char* name, const char* chip_name, unsigned lines) {
  return failure(
      ResultCode::kLineNotFound,
      "lines.%s: expected line '%s' on %s, found lines 0 to %u and none of that name; gpioinfo %s lists them", name,
      spec.line.c_str(), chip_name, lines - 1, chip_name);
}

std::unexpected<Error> not_granted(const LineSpec& spec, const char* name, const char* consumer, int number) {
  if (number == EBUSY) {
    return failure(ResultCode::kLineInUse,
                   "lines.%s: expected line '%s' of %s to be free, found it held by '%s'; end that program or name "
                   "another line",
                   name, spec.line.c_str(), spec.chip.c_str(), consumer != nullptr ? consumer : "the kernel");
  }
  return failure(ResultCode::kLineNotFound, "lines.%s: line '%s' of %s: expected to get it, found: %s; see gpioinfo",
                 name, spec.line.c_str(), spec.chip.c_str(), std::strerror(number));
}

std::unexpected<Error> line_lost(const char* name, int number) {
  return failure(ResultCode::kLinesLost, "lines.%s: lost: %s; check the GPIO chip, its driver and its cable", name,
                 std::strerror(number));
}

}  // namespace beltpick::capture
