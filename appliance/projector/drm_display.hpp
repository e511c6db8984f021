// A display through the kernel's mode setting (DRM/KMS): pages in memory, shown one after the other in step with its
// frame clock. All libdrm is here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace beltpick::projector {

// A page that the display can show: 32 bits a pixel, 0x00RRGGBB.
struct DrmPage {
  std::uint32_t handle = 0;
  std::uint32_t framebuffer = 0;
  std::uint32_t* pixels = nullptr;
  std::uint32_t stride_px = 0;
  std::uint64_t bytes = 0;
};

struct DrmConfig {
  std::string device;     // /dev/dri/card0; empty: the first card with a display
  std::string connector;  // "HDMI-A-1"; empty: the first one with a display
  int width = 0, height = 0;
};

class DrmDisplay {
 public:
  DrmDisplay() = default;
  ~DrmDisplay() { close(); }
  DrmDisplay(const DrmDisplay&) = delete;
  DrmDisplay& operator=(const DrmDisplay&) = delete;

  // Takes the connector's mode of this size (the preferred one, else the fastest) and its screen. Errors:
  // kProjectorLost where there is no such device or display, kProjectorRefused where it has no such mode or somebody
  // else shows on it.
  Result<void> open(const DrmConfig& config);
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  void close();

  // Takes the memory of so many pages. Error: kLimitExceeded.
  Result<void> make_pages(int count);
  [[nodiscard]] DrmPage& page(int index) { return pages_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] int pages() const { return static_cast<int>(pages_.size()); }
  [[nodiscard]] std::uint64_t page_bytes() const;

  // Sets the mode and shows a page at once. Error: kProjectorRefused.
  Result<void> set_mode(int page);
  // Shows a page from the display's next frame on; returns when that begins: monotonic time in us. Allocates nothing.
  // Errors: kProjectorSilent where the display's frame clock stands, kProjectorLost.
  Result<std::int64_t> flip(int page);
  // Whether the display is still connected. Error: kProjectorLost.
  Result<void> check();

  // "card0 HDMI-A-1", and "912x1140 at 60.0 Hz".
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& mode_text() const { return mode_text_; }

 private:
  Result<void> open_card(const std::string& path, const DrmConfig& config);
  Result<void> choose(const DrmConfig& config);
  Result<void> make_page();
  void release_pages();

  int fd_ = -1;
  std::uint32_t connector_ = 0, crtc_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> mode_;  // the kernel's description, as libdrm has it
  std::vector<DrmPage> pages_;
  std::string name_, mode_text_;
};

}  // namespace beltpick::projector
