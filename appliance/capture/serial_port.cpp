#include "capture/serial_port.hpp"

#include <cstring>

#include "base/tty.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

Result<int> open_serial(const char* path) {
  const auto opened = open_tty(path);
  if (opened) return *opened;
  switch (opened.error().fault) {
    case TtyFault::kInUse:
      return failure(ResultCode::kTriggerLost, "trigger %s: another program uses it; end that program", path);
    case TtyFault::kNotATty:
      return failure(ResultCode::kTriggerLost,
                     "trigger %s: expected a tty, found something else; check the configured tty", path);
    default:
      return failure(ResultCode::kTriggerLost,
                     "trigger %s: cannot be opened (%s); check its cable and the configured tty", path,
                     std::strerror(opened.error().error));
  }
}

}  // namespace beltpick::capture
