#include "projector/drm_display.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::projector {

namespace {

constexpr int kFlip_ms = 500;  // many frames of the slowest display
constexpr std::uint32_t kBitsPerPixel = 32, kDepth = 24;
constexpr int kMaxCards = 8;

template <auto release>
struct Release {
  template <class T>
  void operator()(T* of) const {
    release(of);
  }
};
using Resources = std::unique_ptr<drmModeRes, Release<drmModeFreeResources>>;
using Connector = std::unique_ptr<drmModeConnector, Release<drmModeFreeConnector>>;
using Encoder = std::unique_ptr<drmModeEncoder, Release<drmModeFreeEncoder>>;

std::unexpected<Error> lost(const std::string& name, const char* what) {
  return failure(ResultCode::kProjectorLost, "projector %s: %s (%s); check its cable and power, and the device's name",
                 name.c_str(), what, std::strerror(errno));
}

std::string name_of(const drmModeConnector& connector) {
  const char* type = drmModeGetConnectorTypeName(connector.connector_type);
  return std::string(type != nullptr ? type : "Unknown") + "-" + std::to_string(connector.connector_type_id);
}

// The mode of the size that is preferred, else the one with the most frames a second.
const drmModeModeInfo* find_mode(const drmModeConnector& connector, int width, int height) {
  const drmModeModeInfo* best = nullptr;
  for (int i = 0; i < connector.count_modes; ++i) {
    const drmModeModeInfo& mode = connector.modes[i];
    if (mode.hdisplay != width || mode.vdisplay != height) continue;
    if ((mode.type & DRM_MODE_TYPE_PREFERRED) != 0) return &mode;
    if (best == nullptr || mode.vrefresh > best->vrefresh) best = &mode;
  }
  return best;
}

std::string modes_text(const drmModeConnector& connector) {
  std::string text;
  for (int i = 0; i < connector.count_modes && text.size() < 120; ++i) {
    const std::string size =
        std::to_string(connector.modes[i].hdisplay) + "x" + std::to_string(connector.modes[i].vdisplay);
    if (text.find(size) == std::string::npos) text += (text.empty() ? "" : " ") + size;
  }
  return text.empty() ? "none" : text;
}

// A screen that can drive the connector; 0 where there is none.
std::uint32_t find_crtc(int fd, const drmModeRes& resources, const drmModeConnector& connector) {
  for (int e = 0; e < connector.count_encoders; ++e) {
    const Encoder encoder(drmModeGetEncoder(fd, connector.encoders[e]));
    if (!encoder) continue;
    for (int c = 0; c < resources.count_crtcs; ++c) {
      if ((encoder->possible_crtcs & (1U << static_cast<unsigned>(c))) != 0) return resources.crtcs[c];
    }
  }
  return 0;
}

// What a flip's event tells: when the frame began.
struct Flipped {
  bool done = false;
  std::int64_t at_us = 0;
};

void take_flip(int, unsigned, unsigned seconds, unsigned microseconds, unsigned, void* data) {
  auto& flipped = *static_cast<Flipped*>(data);
  flipped.done = true;
  flipped.at_us = std::int64_t{seconds} * 1'000'000 + microseconds;
}

}  // namespace

Result<void> DrmDisplay::open(const DrmConfig& config) {
  if (!config.device.empty()) return open_card(config.device, config);
  Result<void> first = failure(ResultCode::kProjectorLost,
                               "projector: expected a display card (/dev/dri/card0), found none; check its driver");
  for (int i = 0; i < kMaxCards; ++i) {
    const std::string path = "/dev/dri/card" + std::to_string(i);
    if (!std::filesystem::exists(path)) continue;
    const Result<void> opened = open_card(path, config);
    if (opened) return opened;
    if (first.error().code == ResultCode::kProjectorLost) first = opened;
  }
  return first;
}

Result<void> DrmDisplay::open_card(const std::string& path, const DrmConfig& config) {
  close();
  name_ = path.substr(path.rfind('/') + 1) + (config.connector.empty() ? "" : " " + config.connector);
  fd_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0) return lost(path, "cannot be opened");
  std::uint64_t can = 0;
  if (drmGetCap(fd_, DRM_CAP_DUMB_BUFFER, &can) != 0 || can == 0) {
    close();
    return failure(ResultCode::kProjectorRefused, "projector %s: the card cannot show plain memory; use another",
                   path.c_str());
  }
  const Result<void> chosen = choose(config);
  if (!chosen) close();
  return chosen;
}

Result<void> DrmDisplay::choose(const DrmConfig& config) {
  const Resources resources(drmModeGetResources(fd_));
  if (!resources) return lost(name_, "is no display card");
  std::string seen;
  for (int i = 0; i < resources->count_connectors; ++i) {
    const Connector connector(drmModeGetConnector(fd_, resources->connectors[i]));
    if (!connector) continue;
    const std::string name = name_of(*connector);
    const bool connected = connector->connection == DRM_MODE_CONNECTED;
    seen += (seen.empty() ? "" : ", ") + name + (connected ? "" : " (nothing connected)");
    if (!connected || (!config.connector.empty() && config.connector != name)) continue;
    const drmModeModeInfo* mode = find_mode(*connector, config.width, config.height);
    if (mode == nullptr) {
      return failure(
          ResultCode::kProjectorRefused,
          "projector %s: expected a mode of the sequence's %dx%d pixels, found %s; make the sequence for one "
          "of them",
          name.c_str(), config.width, config.height, modes_text(*connector).c_str());
    }
    crtc_ = find_crtc(fd_, *resources, *connector);
    if (crtc_ == 0) return lost(name, "has no screen left");
    connector_ = connector->connector_id;
    width_ = config.width;
    height_ = config.height;
    mode_.resize(sizeof *mode);
    std::memcpy(mode_.data(), mode, sizeof *mode);
    name_ = name_.substr(0, name_.find(' ')) + " " + name;
    char text[64];
    std::snprintf(text, sizeof text, "%dx%d at %u Hz", width_, height_, mode->vrefresh);
    mode_text_ = text;
    return {};
  }
  return failure(ResultCode::kProjectorLost,
                 "projector %s: expected a connected display, found %s; check projector.connector, its cable and power",
                 name_.c_str(), seen.empty() ? "no connector" : seen.c_str());
}

std::uint64_t DrmDisplay::page_bytes() const {
  return static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_) * (kBitsPerPixel / 8);
}

Result<void> DrmDisplay::make_pages(int count) {
  release_pages();
  pages_.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const Result<void> made = make_page();
    if (made) continue;
    const std::string why = std::strerror(errno);
    release_pages();
    return failure(ResultCode::kLimitExceeded,
                   "projector %s: expected memory for %d pages of %.1f MB, found no more after %d (%s); use a shorter "
                   "sequence",
                   name_.c_str(), count, static_cast<double>(page_bytes()) / 1e6, i, why.c_str());
  }
  return {};
}

Result<void> DrmDisplay::make_page() {
  pages_.emplace_back();
  DrmPage& page = pages_.back();
  std::uint32_t pitch = 0;
  std::uint64_t offset = 0;
  const auto width = static_cast<std::uint32_t>(width_);
  const auto height = static_cast<std::uint32_t>(height_);
  const bool made =
      drmModeCreateDumbBuffer(fd_, width, height, kBitsPerPixel, 0, &page.handle, &pitch, &page.bytes) == 0 &&
      drmModeAddFB(fd_, width, height, kDepth, kBitsPerPixel, pitch, page.handle, &page.framebuffer) == 0 &&
      drmModeMapDumbBuffer(fd_, page.handle, &offset) == 0;
  if (!made) return failure(ResultCode::kLimitExceeded, "no page");
  void* memory = ::mmap(nullptr, page.bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, static_cast<off_t>(offset));
  if (memory == MAP_FAILED) return failure(ResultCode::kLimitExceeded, "no page");
  page.pixels = static_cast<std::uint32_t*>(memory);
  page.stride_px = pitch / (kBitsPerPixel / 8);
  return {};
}

void DrmDisplay::release_pages() {
  for (const DrmPage& page : pages_) {
    if (page.pixels != nullptr) ::munmap(page.pixels, page.bytes);
    if (page.framebuffer != 0) drmModeRmFB(fd_, page.framebuffer);
    if (page.handle != 0) drmModeDestroyDumbBuffer(fd_, page.handle);
  }
  pages_.clear();
}

void DrmDisplay::close() {
  if (fd_ < 0) return;
  release_pages();
  ::close(fd_);
  fd_ = -1;
}

Result<void> DrmDisplay::set_mode(int page) {
  drmModeModeInfo mode{};
  std::memcpy(&mode, mode_.data(), sizeof mode);
  if (drmModeSetCrtc(fd_, crtc_, this->page(page).framebuffer, 0, 0, &connector_, 1, &mode) == 0) return {};
  return failure(
      ResultCode::kProjectorRefused,
      "projector %s: expected to set the mode %s, found: %s; end the desktop or other program that shows there",
      name_.c_str(), mode_text_.c_str(), std::strerror(errno));
}

Result<std::int64_t> DrmDisplay::flip(int page) {
  Flipped flipped;
  if (drmModePageFlip(fd_, crtc_, this->page(page).framebuffer, DRM_MODE_PAGE_FLIP_EVENT, &flipped) != 0) {
    return lost(name_, "does not take a page");
  }
  drmEventContext context{};
  context.version = 3;
  context.page_flip_handler2 = take_flip;
  const std::int64_t until_us = monotonic_us() + kFlip_ms * 1000LL;
  while (!flipped.done) {
    const std::int64_t left_us = until_us - monotonic_us();
    pollfd waiting{fd_, POLLIN, 0};
    const int ready = left_us > 0 ? ::poll(&waiting, 1, static_cast<int>(left_us / 1000 + 1)) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      close();  // the event that is still to come must not find its receiver gone
      return failure(ResultCode::kProjectorSilent, "projector %s: expected a page to be shown within %d ms, found none",
                     name_.c_str(), kFlip_ms);
    }
    if (drmHandleEvent(fd_, &context) != 0) return lost(name_, "does not tell what it shows");
  }
  return flipped.at_us;
}

Result<void> DrmDisplay::check() {
  const Connector connector(drmModeGetConnectorCurrent(fd_, connector_));
  if (!connector) return lost(name_, "is gone");
  if (connector->connection == DRM_MODE_CONNECTED) return {};
  return failure(ResultCode::kProjectorLost, "projector %s: expected a connected display, found none; check its cable",
                 name_.c_str());
}

}  // namespace beltpick::projector
