// What can be wrong with a GPIO line, in words; the same for both versions of libgpiod.
#pragma once

#include "base/result.hpp"
#include "capture/lines/line_spec.hpp"

namespace beltpick::capture {

// `number`: errno.
std::unexpected<Error> no_chip(const LineSpec& spec, const char* name, int number);
std::unexpected<Error> no_line(const LineSpec& spec, const char* name, const char* chip_name, unsigned lines);
// `consumer`: who holds it, as the kernel tells; null where it does not.
std::unexpected<Error> not_granted(const LineSpec& spec, const char* name, const char* consumer, int number);
std::unexpected<Error> line_lost(const char* name, int number);

}  // namespace beltpick::capture
