#include "capture/camera.hpp"

#include <pthread.h>
#include <chrono>

#include "capture/gige_camera.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {
constexpr int kAnswerMs = 200;
constexpr int kSilencesToLoss = 3;  // a busy camera may miss one
}  // namespace

std::optional<Frame> CameraLease::wait_frame(std::int64_t timeout_us) { return camera_->wait_frame(timeout_us); }
void CameraLease::requeue(const Frame& frame) { camera_->requeue(frame); }
bool CameraLease::lost() const { return camera_->lost(); }
unsigned CameraLease::generation() const { return camera_->generation(); }

bool CameraLease::answers() {
  const bool there = !camera_->lost() && camera_->answers(kAnswerMs);
  if (!there) owner_->lose();
  return there;
}

Camera::Camera(const CameraConfig& config, Arena& arena) : config_(config) {
  memory_ = arena.take<std::uint8_t>("camera buffers", static_cast<std::size_t>(config.width) *
                                                           static_cast<std::size_t>(config.height) *
                                                           static_cast<std::size_t>(config.buffers));
  error_ = failure(ResultCode::kCameraNotFound, "camera %s: not opened yet", config.name()).error();
}

Camera::~Camera() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_wanted_.notify_all();
  if (keeper_.joinable()) keeper_.join();
}

void Camera::start() {
  keeper_ = std::thread([this] { keep(); });
  ::pthread_setname_np(keeper_.native_handle(), "camera");
}

Error Camera::last_error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

std::string Camera::serial() const {
  const std::lock_guard lock(mutex_);
  return facts_ ? facts_->serial : std::string();
}

std::optional<CameraFacts> Camera::facts() const {
  const std::lock_guard lock(mutex_);
  return facts_;
}

void Camera::remember(const Error& error) {
  const std::lock_guard lock(mutex_);
  error_ = error;
}

// True when it is time to stop.
bool Camera::pause(int milliseconds) {
  std::unique_lock lock(mutex_);
  return stop_wanted_.wait_for(lock, std::chrono::milliseconds(milliseconds), [this] { return stopping_; });
}

void Camera::keep() {
  int silences = 0;
  do {
    if (state_ != CameraState::kReady) {
      open();
      tried_ = true;
      silences = 0;
      continue;
    }
    // A lease that runs judges the camera itself.
    std::unique_lock lock(in_use_, std::try_to_lock);
    if (!lock.owns_lock()) continue;
    silences = camera_->answers(kAnswerMs) ? 0 : silences + 1;
    if (camera_->lost() || silences == kSilencesToLoss) lose();
  } while (!pause(config_.watch_ms));
  const std::lock_guard lock(in_use_);
  if (camera_ != nullptr && !camera_->answers(kAnswerMs)) camera_->abandon();
  camera_.reset();
}

void Camera::open() {
  const std::lock_guard lock(in_use_);
  // What Aravis knows of a lost camera is of no use; but to destroy it takes many seconds while the camera is silent.
  if (camera_ != nullptr && !camera_->answers(kAnswerMs)) return;
  camera_.reset();
  Result<std::unique_ptr<GigeCamera>> opened = GigeCamera::open(config_, memory_);
  if (!opened) {
    remember(opened.error());
    return;
  }
  camera_ = std::move(*opened);
  {
    const std::lock_guard guard(mutex_);
    facts_ = camera_->facts();
  }
  state_ = CameraState::kReady;
}

// With in_use_ held. The keeper opens it anew.
void Camera::lose() {
  camera_->mark_lost();
  remember(failure(ResultCode::kCameraLost,
                   "camera %s: no longer answers; check its cable and power; it is reopened by itself", config_.name())
               .error());
  state_ = CameraState::kLost;
}

Result<CameraLease> Camera::lease() {
  if (state_ != CameraState::kReady) return std::unexpected(last_error());
  // The keeper holds the camera for one sign of life at most, unless it is closing it.
  std::unique_lock lock(in_use_, std::chrono::milliseconds(2 * kAnswerMs));
  if (!lock.owns_lock() || state_ != CameraState::kReady) return std::unexpected(last_error());
  return CameraLease(std::move(lock), *this, camera_.get());
}

}  // namespace beltpick::capture
