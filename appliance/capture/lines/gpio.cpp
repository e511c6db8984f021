#include "capture/lines/gpio.hpp"

namespace beltpick::capture {

Result<void> request_wired(Gpio& gpio, const LineSpec& spec, LineUse use, const char* name,
                           std::unique_ptr<GpioLine>& line) {
  if (!spec.wired()) return {};
  auto requested = gpio.request(spec, use, name);
  if (!requested) return std::unexpected(requested.error());
  line = std::move(*requested);
  return {};
}

}  // namespace beltpick::capture
