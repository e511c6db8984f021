// The controller of a LightCrafter 4500 as a USB HID device sees it from its side: written from the maker's
// programmer's guide alone, sharing no code and no constants with the driver. Takes reports of 64 bytes and answers
// them; keeps what it was told; shows, edge by edge, which bit planes of which flash image would light up. Breaks on
// demand.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace beltpick::test {

class Dlpc350Gadget {
 public:
  using Bytes = std::array<std::uint8_t, 64>;

  enum class Break { kNothing, kRefuse, kSilent, kOtherSequence, kShort };

  // What it does wrong from now on, for one command (0: for all).
  Break breaks = Break::kNothing;
  int breaks_command = 0;
  int images_in_flash = 16;
  std::uint8_t hardware_bits = 0x01;                  // initialised, no fault
  std::array<std::uint8_t, 4> version{{0, 0, 0, 4}};  // patch, patch, minor, major
  int busy_validations = 1;

  // One report of the host in; the reply to it, where one is due, out.
  bool take(const Bytes& report, Bytes& reply) {
    if (wanted_ == 0) {
      head_ = {report[0], report[1]};
      wanted_ = 4U + report[2] + 256U * report[3];
      message_.clear();
    }
    for (std::size_t i = 0; i < 64 && message_.size() < wanted_; ++i) message_.push_back(report[i]);
    if (message_.size() < wanted_) return false;
    wanted_ = 0;
    return answer(reply);
  }

  // What an edge on TRIG_IN_1 shows. `image` is the index in the flash; -1 where nothing would be shown.
  struct Shown {
    int image = -1;
    int first_plane = 0;
    int bits = 0;
  };
  Shown edge() {
    if (!running || mode != 1 || patterns.empty()) return {};
    const std::array<int, 3>& entry = patterns[next_];
    if (next_ == 0) buffer_ = -1;
    if ((entry[2] & 4) != 0) ++buffer_;
    next_ = (next_ + 1) % static_cast<std::size_t>(count);
    const int bits = entry[1] & 15;
    std::vector<int> order = images;
    if (order.size() == 2) order = {images[1], images[0]};  // two buffers, filled from the end of the table
    const int image = buffer_ >= 0 && buffer_ < static_cast<int>(order.size()) ? order[buffer_] : -1;
    return {image, (entry[0] >> 2) * bits, bits};
  }

  // What it was told.
  int mode = 0, source = 0, trigger = 0, count = 0, repeat = 0, image_count = 0;
  bool running = false;
  std::uint32_t exposure_us = 0, period_us = 0, trigger_delay = 0;
  std::vector<int> images;
  std::vector<std::array<int, 3>> patterns;
  std::vector<int> commands;  // in the order in which they came

 private:
  bool answer(Bytes& reply) {
    const int command = message_[5] << 8 | message_[4];
    commands.push_back(command);
    const bool is_read = (head_[0] & 0x80) != 0;
    const bool broken = breaks != Break::kNothing && (breaks_command == 0 || breaks_command == command);
    if (broken && breaks == Break::kSilent) return false;
    data_.assign(message_.begin() + 6, message_.end());
    std::vector<std::uint8_t> out;
    const bool good = (is_read ? read(command, out) : write(command)) && !(broken && breaks == Break::kRefuse);
    if ((head_[0] & 0x40) == 0) return false;
    if (broken && breaks == Break::kShort) out.clear();
    reply = {};
    reply[0] = static_cast<std::uint8_t>(head_[0] | (good ? 0 : 0x20));
    reply[1] = static_cast<std::uint8_t>(head_[1] + (broken && breaks == Break::kOtherSequence ? 1 : 0));
    reply[2] = static_cast<std::uint8_t>(out.size());
    std::copy(out.begin(), out.end(), reply.begin() + 4);
    return true;
  }

  [[nodiscard]] std::uint32_t number(std::size_t at) const {
    return static_cast<std::uint32_t>(data_[at] | data_[at + 1] << 8 | data_[at + 2] << 16) |
           static_cast<std::uint32_t>(data_[at + 3]) << 24;
  }

  // What changes the sequence needs it to stand.
  bool write(int command) {
    const std::size_t size = data_.size();
    if (command == 0x1A24) return size == 1 && start_stop(data_[0]);
    if (running) return false;
    switch (command) {
      case 0x1A1B:
        return size == 1 && data_[0] <= 1 && (mode = data_[0], true);
      case 0x1A22:
        return size == 1 && (data_[0] == 0 || data_[0] == 3) && (source = data_[0], true);
      case 0x1A23:
        return size == 1 && data_[0] <= 4 && (trigger = data_[0], true);
      case 0x1A29:
        return size == 8 && (exposure_us = number(0), period_us = number(4), true);
      case 0x1A31:
        return size == 4 && (count = data_[0] + 1, repeat = data_[1], image_count = data_[3] + 1, true);
      case 0x1A32:
        return size == 1 && mailbox_ != 0 && (offset_ = data_[0], true);
      case 0x1A33:
        return size == 1 && data_[0] <= 3 && (mailbox_ = data_[0], true);
      case 0x1A34:
        return fill_mailbox();
      case 0x1A35:
        return size == 4 && (trigger_delay = number(0), true);
      case 0x1A1A:
        return validation_left_ = busy_validations, true;
      default:
        return false;
    }
  }

  bool start_stop(int action) {
    if (action == 0) next_ = 0;
    if (action == 2 && mode != 1) return false;
    running = action == 2;
    return action <= 2;
  }

  bool fill_mailbox() {
    if (mailbox_ == 1) {
      images.assign(data_.begin(), data_.end());
      return offset_ == 0;
    }
    if (mailbox_ != 2 || data_.size() % 3 != 0) return false;
    patterns.clear();
    for (std::size_t i = 0; i + 2 < data_.size(); i += 3) patterns.push_back({data_[i], data_[i + 1], data_[i + 2]});
    return offset_ == 0;
  }

  bool read(int command, std::vector<std::uint8_t>& out) {
    switch (command) {
      case 0x0205:
        out.assign(16, 0);
        std::copy(version.begin(), version.end(), out.begin());
        return true;
      case 0x1A0A:
        out = {hardware_bits};
        return true;
      case 0x1A0C:
        out = {static_cast<std::uint8_t>(running ? 2 : 0)};
        return true;
      case 0x1A42:
        out = {static_cast<std::uint8_t>(images_in_flash)};
        return true;
      case 0x1A1B:
        out = {static_cast<std::uint8_t>(mode)};
        return true;
      case 0x1A22:
        out = {static_cast<std::uint8_t>(source)};
        return true;
      case 0x1A24:
        out = {static_cast<std::uint8_t>(running ? 2 : 0)};
        return true;
      case 0x1A1A:
        out = {validate()};
        return true;
      default:
        return false;
    }
  }

  std::uint8_t validate() {
    if (validation_left_-- > 0) return 0x80;
    static constexpr std::array<std::uint32_t, 8> kShortest{235, 700, 1570, 1700, 2000, 2500, 4500, 8333};
    unsigned bits = 0;
    if (static_cast<int>(patterns.size()) != count || static_cast<int>(images.size()) != image_count) bits |= 2;
    for (const int image : images) bits |= image >= images_in_flash ? 2 : 0;
    for (const auto& entry : patterns) {
      const int depth = entry[1] & 15;
      if (depth < 1 || depth > 8 || ((entry[0] >> 2) + 1) * depth > 24) bits |= 2;
      if (depth >= 1 && depth <= 8 && exposure_us < kShortest[static_cast<std::size_t>(depth - 1)]) bits |= 1;
      const bool external = (entry[0] & 3) == 1 || (entry[0] & 3) == 2;
      if (external && (entry[2] & 2) == 0) bits |= 8;
    }
    if (period_us != exposure_us && period_us < exposure_us + 230) bits |= 16;
    return static_cast<std::uint8_t>(bits);
  }

  std::array<std::uint8_t, 2> head_{};
  std::size_t wanted_ = 0;
  std::vector<std::uint8_t> message_, data_;
  int mailbox_ = 0, offset_ = 0, validation_left_ = 0, buffer_ = -1;
  std::size_t next_ = 0;
};

}  // namespace beltpick::test
