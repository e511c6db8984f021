// Camera: the cell's GigE Vision camera as the capture sees it. A keeper thread of its own opens it, watches it and,
// once it is lost, destroys and opens it anew; the capture thread leases it for the time of a capture and allocates
// nothing.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "base/arena.hpp"
#include "base/image.hpp"
#include "base/result.hpp"

namespace beltpick::capture {

class Camera;
class GigeCamera;

// What the camera that was opened last told of itself, for the self-test.
struct CameraFacts {
  std::string model;
  std::string serial;
  std::string address;  // IPv4
  int sensor_width = 0;
  int sensor_height = 0;
  bool trigger_width = false;  // ExposureMode TriggerWidth; without it the exposure time is fixed
  int packet_bytes = 0;        // of its stream, IP header included
};

struct CameraConfig {
  std::string id;  // IPv4 address (best), or serial number; empty: the first one found
  int width = 1280;
  int height = 960;
  int buffers = 24;                 // frames that may lie between network and fold: a whole sequence, if memory allows
  double timed_exposure_us = 8000;  // of a camera that has no ExposureMode TriggerWidth
  bool packet_socket = false;       // Aravis' raw socket: needs CAP_NET_RAW, saves copies
  int watch_ms = 500;               // between two signs of life, and between two attempts to open

  // For messages.
  [[nodiscard]] const char* name() const { return id.empty() ? "(the first one found)" : id.c_str(); }
};

enum class CameraState : std::uint8_t { kOpening, kReady, kLost };

// One frame as it arrived. `code` kOk, or why it cannot be used: kFrameIncomplete, kFrameWrongSize.
struct Frame {
  void* buffer = nullptr;  // Aravis' buffer; goes back through CameraLease::requeue
  std::uint64_t frame_id = 0;
  ResultCode code{};
  ImageView<const std::uint8_t> image;  // valid until requeued
};

// The camera while a capture uses it: the keeper leaves it alone. Made by Camera::lease().
class CameraLease {
 public:
  // The next frame in the order of arrival, or nothing within the time. Does not allocate.
  std::optional<Frame> wait_frame(std::int64_t timeout_us);
  void requeue(const Frame& frame);
  // True once the camera said goodbye or does not answer.
  [[nodiscard]] bool lost() const;
  // Asks the camera for a sign of life; false after 200 ms without one. Tells a dead camera from one that missed a
  // trigger.
  bool answers();
  // Another number for every time the camera was opened: frame ids begin anew then.
  [[nodiscard]] unsigned generation() const;

 private:
  friend class Camera;
  CameraLease(std::unique_lock<std::timed_mutex> lock, Camera& owner, GigeCamera* camera)
      : lock_(std::move(lock)), owner_(&owner), camera_(camera) {}

  std::unique_lock<std::timed_mutex> lock_;
  Camera* owner_;
  GigeCamera* camera_;
};

class Camera {
 public:
  // Takes the frame buffers from the arena; config.width * height * buffers bytes.
  Camera(const CameraConfig& config, Arena& arena);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  // Starts the keeper; returns at once. state() tells when the camera is there.
  void start();

  [[nodiscard]] CameraState state() const { return state_; }
  // kCameraNotFound, kCameraLost, kFrameWrongSize (sensor too small for the configured size), ... while not ready.
  [[nodiscard]] Error last_error() const;
  // Serial number of the camera opened last; empty before.
  [[nodiscard]] std::string serial() const;
  // Nothing while no camera was opened yet.
  [[nodiscard]] std::optional<CameraFacts> facts() const;
  [[nodiscard]] bool started() const { return keeper_.joinable(); }
  // True once it is known whether the camera can be opened.
  [[nodiscard]] bool tried() const { return tried_; }

  // For one capture thread. Fails with last_error() while the camera is not ready.
  Result<CameraLease> lease();
  [[nodiscard]] int width() const { return config_.width; }
  [[nodiscard]] int height() const { return config_.height; }

 private:
  friend class CameraLease;

  void keep();
  void open();
  void lose();
  bool pause(int milliseconds);
  void remember(const Error& error);

  CameraConfig config_;
  std::span<std::uint8_t> memory_;
  std::atomic<CameraState> state_{CameraState::kOpening};

  std::timed_mutex in_use_;  // held by a lease, and by the keeper while it opens and closes
  std::unique_ptr<GigeCamera> camera_;
  std::atomic<bool> tried_{false};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable stop_wanted_;
  bool stopping_ = false;
  Error error_;
  std::optional<CameraFacts> facts_;
  std::thread keeper_;
};

}  // namespace beltpick::capture
