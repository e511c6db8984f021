// Gpio by libgpiod 2 (Debian 13).
#include <fcntl.h>
#include <gpiod.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "capture/lines/gpio.hpp"
#include "capture/lines/gpio_errors.hpp"

namespace beltpick::capture {

namespace {

template <auto function>
struct Free {
  template <class T>
  void operator()(T* object) const {
    function(object);
  }
};
template <class T, auto function>
using Owned = std::unique_ptr<T, Free<function>>;

using Chip = Owned<gpiod_chip, gpiod_chip_close>;
using ChipInfo = Owned<gpiod_chip_info, gpiod_chip_info_free>;
using LineInfo = Owned<gpiod_line_info, gpiod_line_info_free>;
using LineSettings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, gpiod_request_config_free>;
using LineRequest = Owned<gpiod_line_request, gpiod_line_request_release>;
using EdgeBuffer = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;

class RequestedLine : public GpioLine {
 public:
  RequestedLine(LineRequest request, unsigned offset, std::string name)
      : request_(std::move(request)), offset_(offset), name_(std::move(name)), edges_(gpiod_edge_event_buffer_new(1)) {
    if (edges_ == nullptr) throw std::bad_alloc();
  }

  Result<bool> read() override {
    const gpiod_line_value level = gpiod_line_request_get_value(request_.get(), offset_);
    if (level == GPIOD_LINE_VALUE_ERROR) return line_lost(name_.c_str(), errno);
    return level == GPIOD_LINE_VALUE_ACTIVE;
  }

  Result<void> write(bool active) override {
    const gpiod_line_value level = active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    if (gpiod_line_request_set_value(request_.get(), offset_, level) != 0) return line_lost(name_.c_str(), errno);
    return {};
  }

  Result<std::optional<LineEdge>> next_edge() override {
    const int count = gpiod_line_request_read_edge_events(request_.get(), edges_.get(), 1);
    if (count < 0) {
      if (errno == EAGAIN) return std::nullopt;
      return line_lost(name_.c_str(), errno);
    }
    gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(edges_.get(), 0);
    return LineEdge{gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
                    static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event) / 1000)};
  }

  [[nodiscard]] int edge_fd() const override { return gpiod_line_request_get_fd(request_.get()); }

 private:
  LineRequest request_;
  unsigned offset_;
  std::string name_;
  EdgeBuffer edges_;
};

// By path, by name or by label, as version 1 looks a chip up; null with errno.
Chip open_chip(const std::string& wanted) {
  if (wanted.find('/') != std::string::npos) return Chip(gpiod_chip_open(wanted.c_str()));
  const std::string path = "/dev/" + wanted;
  if (gpiod_is_gpiochip_device(path.c_str())) return Chip(gpiod_chip_open(path.c_str()));
  int problem = ENOENT;
  std::error_code unreadable;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", unreadable)) {
    if (!gpiod_is_gpiochip_device(entry.path().c_str())) continue;
    Chip chip(gpiod_chip_open(entry.path().c_str()));
    if (chip == nullptr) {
      problem = errno;
      continue;
    }
    const ChipInfo info(gpiod_chip_get_info(chip.get()));
    if (info != nullptr && wanted == gpiod_chip_info_get_label(info.get())) return chip;
  }
  errno = problem;
  return nullptr;
}

// -1 where there is no such line.
int find_line(gpiod_chip* chip, const LineSpec& spec, unsigned lines) {
  const auto number = line_number(spec);
  if (!number) return gpiod_chip_get_line_offset_from_name(chip, spec.line.c_str());
  return *number < lines ? static_cast<int>(*number) : -1;
}

LineConfig config_of(const LineSpec& spec, LineUse use, unsigned offset) {
  const LineSettings settings(gpiod_line_settings_new());
  LineConfig config(gpiod_line_config_new());
  if (settings == nullptr || config == nullptr) return nullptr;
  if (use == LineUse::kOutput) {
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
    gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
  } else {
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
    gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  }
  gpiod_line_settings_set_active_low(settings.get(), spec.active_low);
  if (spec.bias == LineBias::kPullUp) gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_PULL_UP);
  if (spec.bias == LineBias::kPullDown) gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_PULL_DOWN);
  const bool added = gpiod_line_config_add_line_settings(config.get(), &offset, 1, settings.get()) == 0;
  return added ? std::move(config) : nullptr;
}

class LibGpio2 : public Gpio {
 public:
  Result<std::unique_ptr<GpioLine>> request(const LineSpec& spec, LineUse use, const char* name) override {
    const Chip chip = open_chip(spec.chip);
    if (chip == nullptr) return no_chip(spec, name, errno);
    const ChipInfo info(gpiod_chip_get_info(chip.get()));
    if (info == nullptr) return no_chip(spec, name, errno);
    const auto lines = static_cast<unsigned>(gpiod_chip_info_get_num_lines(info.get()));
    const int found = find_line(chip.get(), spec, lines);
    if (found < 0) return no_line(spec, name, gpiod_chip_info_get_name(info.get()), lines);
    const auto offset = static_cast<unsigned>(found);

    const RequestConfig whose(gpiod_request_config_new());
    const LineConfig config = config_of(spec, use, offset);
    if (whose == nullptr || config == nullptr) return not_granted(spec, name, nullptr, errno);
    gpiod_request_config_set_consumer(whose.get(), (std::string("beltpick ") + name).c_str());
    LineRequest request(gpiod_chip_request_lines(chip.get(), whose.get(), config.get()));
    if (request == nullptr) {
      const int number = errno;
      const LineInfo line(gpiod_chip_get_line_info(chip.get(), offset));
      return not_granted(spec, name, line != nullptr ? gpiod_line_info_get_consumer(line.get()) : nullptr, number);
    }
    ::fcntl(gpiod_line_request_get_fd(request.get()), F_SETFL, O_NONBLOCK);
    return std::make_unique<RequestedLine>(std::move(request), offset, name);
  }
};

}  // namespace

Gpio& gpio_of_this_pc() {
  static LibGpio2 gpio;
  return gpio;
}

const char* gpio_library_version() { return gpiod_api_version(); }

}  // namespace beltpick::capture
