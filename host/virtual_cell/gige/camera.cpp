#include "virtual_cell/gige/camera.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "virtual_cell/gige/registers.hpp"

namespace beltpick::virtual_cell::gige {

Result<std::unique_ptr<Camera>> Camera::open(CameraSettings settings) {
  in_addr parsed{};
  if (::inet_pton(AF_INET, settings.address.c_str(), &parsed) != 1) {
    return failure(ResultCode::kServiceUnreachable, "virtual camera: '%s' is no IPv4 address; expected e.g. 127.0.0.1",
                   settings.address.c_str());
  }
  const std::uint32_t ip = ntohl(parsed.s_addr);
  const double rate = settings.bytes_per_second;
  std::unique_ptr<Camera> camera(new Camera(std::move(settings), ip));
  auto stream = StreamChannel::open(ip, rate);
  if (!stream) return std::unexpected(stream.error());
  camera->stream_ = std::move(*stream);
  camera->bank_.set(address::kStreamSourcePort, camera->stream_->port());
  Camera* raw = camera.get();
  ControlEvents events;
  events.written = [raw](std::uint32_t at, std::uint32_t value) { raw->register_written(at, value); };
  events.resend = [raw](std::uint16_t block, std::uint32_t first, std::uint32_t last) {
    raw->stream_->resend(block, first, last, raw->destination());
  };
  events.control_lost = [raw] { raw->stop_acquisition(); };
  auto control = ControlChannel::open(ip, camera->bank_, std::move(events));
  if (!control) return std::unexpected(control.error());
  camera->control_ = std::move(*control);
  camera->exposure_ = std::thread([raw] { raw->run_exposures(); });
  camera->readout_ = std::thread([raw] { raw->run_readout(); });
  return camera;
}

Camera::Camera(CameraSettings settings, std::uint32_t ip)
    : settings_(std::move(settings)),
      bank_(settings_.identity, ip),
      image_(static_cast<std::size_t>(settings_.identity.width) * static_cast<std::size_t>(settings_.identity.height)),
      block_id_(settings_.first_block_id) {}

Camera::~Camera() {
  control_.reset();
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (exposure_.joinable()) exposure_.join();
  if (readout_.joinable()) readout_.join();
}

void Camera::register_written(std::uint32_t at, std::uint32_t value) {
  if (at == address::kAcquisitionStart && value != 0) acquiring_ = true;
  if (at == address::kAcquisitionStop && value != 0) stop_acquisition();
  if (at == address::kStreamPacketSize && (value >> 31U) != 0) stream_->fire_test_packet(destination());
  if (at == address::kTriggerSoftware && value != 0 && bank_.get(address::kTriggerSource) == kSourceSoftware) {
    const std::int64_t now_us = monotonic_us();
    const std::scoped_lock lock(mutex_);
    exposing_.push_back({{0, now_us, now_us + std::llround(bank_.get_double(address::kExposureTime))}, {}});
    wake_.notify_all();
  }
  configure_sensor();
}

void Camera::configure_sensor() {
  SensorSettings settings;
  settings.acquiring = acquiring_;
  settings.line_triggered = bank_.get(address::kTriggerMode) != 0 && bank_.get(address::kTriggerSource) == kSourceLine0;
  settings.active_low = bank_.get(address::kTriggerActivation) == kFallingEdge;
  settings.trigger_width = bank_.get(address::kExposureMode) == kTriggerWidth;
  settings.exposure_us = bank_.get_double(address::kExposureTime);
  std::optional<Exposure> dropped;
  {
    const std::scoped_lock lock(mutex_);
    dropped = sensor_.configure(settings);
  }
  if (!dropped || !settings_.exposure_ended) return;
  dropped->end_us = monotonic_us();
  settings_.exposure_ended(*dropped);
}

void Camera::stop_acquisition() {
  acquiring_ = false;
  configure_sensor();
  const std::scoped_lock lock(mutex_);
  exposing_.clear();
  exposed_.clear();
}

std::optional<FrameFault> Camera::take_fault() {
  const auto found = faults_.find(edges_++);
  if (found == faults_.end()) return std::nullopt;
  const FrameFault fault = found->second;
  faults_.erase(found);
  return fault;
}

void Camera::line_edge(bool rising, std::int64_t time_us) {
  if (dead_ || !acquiring_) return;
  const bool active = rising != (bank_.get(address::kTriggerActivation) == kFallingEdge);
  std::optional<Sensor::Event> event;
  {
    const std::scoped_lock lock(mutex_);
    if (active) {
      const auto fault = take_fault();
      if (fault == FrameFault::kMissTrigger) return;
      event = sensor_.edge(rising, time_us);
      if (event) current_fault_ = fault;
      bank_.set(address::kEdgesWhileExposing, sensor_.edges_while_exposing());
    } else {
      event = sensor_.edge(rising, time_us);
    }
  }
  if (!event) return;
  if (event->started && settings_.exposure_began) settings_.exposure_began(event->exposure);
  if (event->ended && settings_.exposure_ended) settings_.exposure_ended(event->exposure);
  if (event->exposure.end_us == 0) return;
  const std::scoped_lock lock(mutex_);
  (event->ended ? exposed_ : exposing_).push_back({event->exposure, current_fault_});
  wake_.notify_all();
}

bool Camera::take(std::deque<Shot>& from, Shot& shot) {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [&] { return stop_ || !from.empty(); });
  if (stop_) return false;
  shot = from.front();
  from.pop_front();
  return true;
}

// Ends Timed exposures on time, whatever the readout of the frame before still does.
void Camera::run_exposures() {
  Shot shot;
  while (take(exposing_, shot)) {
    const std::int64_t left_us = shot.exposure.end_us - monotonic_us();
    if (left_us > 0) std::this_thread::sleep_for(std::chrono::microseconds(left_us));
    if (settings_.exposure_ended) settings_.exposure_ended(shot.exposure);
    const std::scoped_lock lock(mutex_);
    exposed_.push_back(shot);
    wake_.notify_all();
  }
}

void Camera::run_readout() {
  Shot shot;
  while (take(exposed_, shot)) {
    if (acquiring_ && !dead_) read_out(shot);
  }
}

void Camera::read_out(const Shot& shot) {
  const auto frame = make_frame(shot);
  block_id_ = block_id_ == UINT16_MAX ? std::uint16_t{1} : static_cast<std::uint16_t>(block_id_ + 1);
  if (shot.fault == FrameFault::kLoseFrame || dead_ || frame->pixels.empty()) return;
  stream_->send(frame, destination(), packet_loss_);
}

std::shared_ptr<StreamFrame> Camera::make_frame(const Shot& shot) {
  const ImageView<std::uint8_t> image(image_.data(), settings_.identity.height, settings_.identity.width);
  if (shot.fault == FrameFault::kBlack) {
    std::fill(image_.begin(), image_.end(), std::uint8_t{0});
  } else if (shot.fault != FrameFault::kDuplicate && settings_.fill) {
    settings_.fill(image, shot.exposure);
  }
  auto frame = std::make_shared<StreamFrame>();
  frame->block_id = block_id_;
  frame->stamp_us = static_cast<std::uint64_t>(shot.exposure.start_us);
  const auto offset_x = std::min<std::uint32_t>(bank_.get(address::kOffsetX), static_cast<std::uint32_t>(image.cols));
  const auto offset_y = std::min<std::uint32_t>(bank_.get(address::kOffsetY), static_cast<std::uint32_t>(image.rows));
  frame->width = std::min(bank_.get(address::kWidth), static_cast<std::uint32_t>(image.cols) - offset_x);
  frame->height = std::min(bank_.get(address::kHeight), static_cast<std::uint32_t>(image.rows) - offset_y);
  if (shot.fault == FrameFault::kWrongSize) frame->height /= 2;
  frame->pixels.reserve(std::size_t{frame->width} * frame->height);
  for (std::uint32_t row = 0; row < frame->height; ++row) {
    const std::uint8_t* from = image.row(static_cast<int>(row + offset_y)) + offset_x;
    frame->pixels.insert(frame->pixels.end(), from, from + frame->width);
  }
  const std::uint32_t overhead = kIpUdpHeaderBytes + kGvspHeaderBytes;
  frame->payload_bytes = std::max(destination().packet_bytes, overhead + 64U) - overhead;
  if (shot.fault == FrameFault::kShortFrame) frame->broken_from = 1 + frame->payload_packets() * 2 / 3;
  return frame;
}

StreamDestination Camera::destination() const {
  StreamDestination destination;
  destination.to.sin_family = AF_INET;
  destination.to.sin_port = htons(static_cast<std::uint16_t>(bank_.get(address::kStreamPort)));
  destination.to.sin_addr.s_addr = htonl(bank_.get(address::kStreamAddress));
  destination.packet_bytes = bank_.get(address::kStreamPacketSize) & 0xffffU;
  return destination;
}

void Camera::inject(FrameFault fault, int frames_ahead) {
  const std::scoped_lock lock(mutex_);
  faults_[edges_ + static_cast<std::uint64_t>(std::max(frames_ahead, 0))] = fault;
}

void Camera::die() {
  dead_ = true;
  control_->set_silent(true);
  stop_acquisition();
}

void Camera::revive() {
  if (!dead_) return;
  bank_.power_cycle();
  bank_.set(address::kStreamSourcePort, stream_->port());
  configure_sensor();
  dead_ = false;
  control_->set_silent(false);
}

std::uint32_t Camera::edges_while_exposing() const {
  const std::scoped_lock lock(mutex_);
  return sensor_.edges_while_exposing();
}

}  // namespace beltpick::virtual_cell::gige
