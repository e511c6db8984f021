// Gpio by libgpiod 1 (Debian 12).
#include <fcntl.h>
#include <gpiod.h>

#include <cerrno>
#include <string>

#include "capture/lines/gpio.hpp"
#include "capture/lines/gpio_errors.hpp"

namespace beltpick::capture {

namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

int flags_of(const LineSpec& spec) {
  int flags = spec.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (spec.bias == LineBias::kPullUp) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
  if (spec.bias == LineBias::kPullDown) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
  return flags;
}

class LineOfChip : public GpioLine {
 public:
  LineOfChip(Chip chip, gpiod_line* line, std::string name, int edge_fd)
      : chip_(std::move(chip)), line_(line), name_(std::move(name)), edge_fd_(edge_fd) {}

  Result<bool> read() override {
    const int level = gpiod_line_get_value(line_);
    if (level < 0) return line_lost(name_.c_str(), errno);
    return level == 1;
  }

  Result<void> write(bool active) override {
    if (gpiod_line_set_value(line_, active ? 1 : 0) != 0) return line_lost(name_.c_str(), errno);
    return {};
  }

  Result<std::optional<LineEdge>> next_edge() override {
    gpiod_line_event event{};
    if (gpiod_line_event_read_fd(edge_fd_, &event) == 0) {
      return LineEdge{event.event_type == GPIOD_LINE_EVENT_RISING_EDGE,
                      std::int64_t{event.ts.tv_sec} * 1'000'000 + event.ts.tv_nsec / 1000};
    }
    if (errno == EAGAIN) return std::nullopt;
    return line_lost(name_.c_str(), errno);
  }

  [[nodiscard]] int edge_fd() const override { return edge_fd_; }

 private:
  Chip chip_;  // the line goes with it
  gpiod_line* line_;
  std::string name_;
  int edge_fd_;
};

gpiod_line* find_line(gpiod_chip* chip, const LineSpec& spec) {
  if (const auto number = line_number(spec)) return gpiod_chip_get_line(chip, *number);
  return gpiod_chip_find_line(chip, spec.line.c_str());
}

class LibGpio1 : public Gpio {
 public:
  Result<std::unique_ptr<GpioLine>> request(const LineSpec& spec, LineUse use, const char* name) override {
    Chip chip(gpiod_chip_open_lookup(spec.chip.c_str()));
    if (chip == nullptr) return no_chip(spec, name, errno);
    gpiod_line* line = find_line(chip.get(), spec);
    if (line == nullptr) return no_line(spec, name, gpiod_chip_name(chip.get()), gpiod_chip_num_lines(chip.get()));
    const std::string consumer = std::string("beltpick ") + name;
    const int type =
        use == LineUse::kOutput ? GPIOD_LINE_REQUEST_DIRECTION_OUTPUT : GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
    const gpiod_line_request_config config{consumer.c_str(), type, flags_of(spec)};
    if (gpiod_line_request(line, &config, 0) != 0) {
      const int number = errno;
      return not_granted(spec, name, gpiod_line_consumer(line), number);
    }
    const int fd = use == LineUse::kOutput ? -1 : gpiod_line_event_get_fd(line);
    if (fd >= 0) ::fcntl(fd, F_SETFL, O_NONBLOCK);
    return std::make_unique<LineOfChip>(std::move(chip), line, name, fd);
  }
};

}  // namespace

Gpio& gpio_of_this_pc() {
  static LibGpio1 gpio;
  return gpio;
}

const char* gpio_library_version() { return gpiod_version_string(); }

}  // namespace beltpick::capture
