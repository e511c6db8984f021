#include "capture/gige_camera.hpp"

#include <arpa/inet.h>
#include <arv.h>
#include <pthread.h>

#include <cstring>

#include "base/thread_priority.hpp"
#include "capture/receive_buffer.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {

constexpr int kFirstAnswerMs = 500;              // the network has to find the address first
constexpr unsigned kPacketTimeoutUs = 20'000;    // before a packet is asked for again
constexpr unsigned kFrameRetentionUs = 500'000;  // before a frame with holes is given up
constexpr double kResendShare = 1.0;  // of a frame's packets that may be asked for again: a late frame beats none

// Calls an Aravis function with a GError behind its arguments and turns a failure into ours.
template <class Call>
Result<void> step(const CameraConfig& config, ResultCode code, const char* what, Call call) {
  GError* error = nullptr;
  call(&error);
  if (error == nullptr) return {};
  const Result<void> failed =
      failure(code, "camera %s: %s: %s; check address, cable, power and that no other program holds it", config.name(),
              what, error->message);
  g_error_free(error);
  return failed;
}

// For what a camera may lack or refuse without harm.
template <class Call>
void try_step(Call call) {
  GError* error = nullptr;
  call(&error);
  g_clear_error(&error);
}

bool has_entry(ArvCamera* camera, const char* feature, const char* entry) {
  bool found = false;
  try_step([&](GError** e) { found = arv_camera_is_enumeration_entry_available(camera, feature, entry, e); });
  return found;
}

void prepare_thread(void*, ArvStreamCallbackType type, ArvBuffer*) {
  if (type != ARV_STREAM_CALLBACK_TYPE_INIT) return;
  ::pthread_setname_np(::pthread_self(), "aravis-stream");
  make_realtime(RealtimePriority::kStream);
}

ResultCode code_of(ArvBufferStatus status) {
  if (status == ARV_BUFFER_STATUS_SUCCESS) return ResultCode::kOk;
  return status == ARV_BUFFER_STATUS_SIZE_MISMATCH ? ResultCode::kFrameWrongSize : ResultCode::kFrameIncomplete;
}

in_addr address_of(ArvDevice* device) {
  in_addr address{};
  GSocketAddress* socket_address = arv_gv_device_get_device_address(ARV_GV_DEVICE(device));
  GInetAddress* inet = g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(socket_address));
  if (g_inet_address_get_native_size(inet) == sizeof address) {
    std::memcpy(&address, g_inet_address_to_bytes(inet), sizeof address);
  }
  return address;
}

std::string address_text(in_addr address) {
  char text[INET_ADDRSTRLEN]{};
  ::inet_ntop(AF_INET, &address, text, sizeof text);
  return text;
}

std::unexpected<Error> in_use(const CameraConfig& config, GvcpProbe& probe) {
  const auto holder = probe.controller(kFirstAnswerMs).value_or(GvcpProbe::Controller{});
  const std::string where = holder.address.s_addr == 0 ? "" : " at " + address_text(holder.address);
  return failure(ResultCode::kCameraInUse, "camera %s: another program%s controls it; end that program", config.name(),
                 where.c_str());
}

// Aravis needs seconds to find out that nobody is there, or that somebody else has the camera.
Result<void> ask_first(const CameraConfig& config, in_addr address) {
  GvcpProbe probe(address);
  const auto controller = probe.controller(kFirstAnswerMs);
  if (!controller) {
    return failure(ResultCode::kCameraNotFound, "camera %s: does not answer; check address, cable and power",
                   config.name());
  }
  if (controller->there) return in_use(config, probe);
  return {};
}

}  // namespace

GigeCamera::GigeCamera(const CameraConfig& config) : config_(config) {
  static std::atomic<unsigned> generations{0};
  generation_ = ++generations;
}

Result<std::unique_ptr<GigeCamera>> GigeCamera::open(const CameraConfig& config, std::span<std::uint8_t> memory) {
  in_addr address{};
  if (::inet_pton(AF_INET, config.id.c_str(), &address) == 1) {
    if (const auto there = ask_first(config, address); !there) return std::unexpected(there.error());
  }
  std::unique_ptr<GigeCamera> camera(new GigeCamera(config));
  Result<void> done = camera->connect();
  if (done) done = camera->configure();
  if (done) done = camera->start_stream(memory);
  if (!done) return std::unexpected(done.error());
  return camera;
}

GigeCamera::~GigeCamera() {
  // A lost camera would let us wait for its reply to the stop.
  if (stream_ != nullptr && !lost_) try_step([&](GError** e) { arv_camera_stop_acquisition(camera_, e); });
  if (lost_signal_ != 0) g_signal_handler_disconnect(arv_camera_get_device(camera_), lost_signal_);
  g_clear_object(&stream_);
  g_clear_object(&camera_);
}

void GigeCamera::abandon() {
  if (lost_signal_ != 0) g_signal_handler_disconnect(arv_camera_get_device(camera_), lost_signal_);
  lost_signal_ = 0;
  stream_ = nullptr;
  camera_ = nullptr;
}

Result<void> GigeCamera::connect() {
  const Result<void> opened = step(config_, ResultCode::kCameraNotFound, "cannot be opened", [&](GError** e) {
    const char* first_found = nullptr;
    camera_ = arv_camera_new(config_.id.empty() ? first_found : config_.id.c_str(), e);
  });
  if (!opened) return opened;
  if (camera_ == nullptr || !arv_camera_is_gv_device(camera_)) {
    return failure(ResultCode::kCameraNotFound,
                   "camera %s: expected a GigE Vision camera, found none; check address or serial number",
                   config_.name());
  }
  ArvDevice* device = arv_camera_get_device(camera_);
  lost_signal_ =
      g_signal_connect_swapped(device, "control-lost", G_CALLBACK(+[](GigeCamera* self) { self->lost_ = true; }), this);
  probe_.emplace(address_of(device));
  if (!arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return in_use(config_, *probe_);
  facts_.address = address_text(address_of(device));
  return identify();
}

Result<void> GigeCamera::identify() {
  const auto text = [](const char* found) { return std::string(found != nullptr ? found : ""); };
  try_step([&](GError** e) { facts_.model = text(arv_camera_get_model_name(camera_, e)); });
  return step(config_, ResultCode::kCameraLost, "serial number",
              [&](GError** e) { facts_.serial = text(arv_camera_get_device_serial_number(camera_, e)); });
}

Result<void> GigeCamera::configure() {
  Result<void> done = configure_region();
  if (done) done = configure_exposure();
  if (!done) return done;
  // AcquisitionStart as the selector arms some cameras for one frame only; FrameStart is what a pulse a frame means.
  return step(config_, ResultCode::kCameraLost, "trigger", [&](GError** e) {
    arv_camera_set_acquisition_mode(camera_, ARV_ACQUISITION_MODE_CONTINUOUS, e);
    if (*e == nullptr) arv_camera_clear_triggers(camera_, e);
    if (*e == nullptr) arv_camera_set_string(camera_, "TriggerSelector", "FrameStart", e);
    if (*e == nullptr) arv_camera_set_string(camera_, "TriggerMode", "On", e);
    if (*e == nullptr) arv_camera_set_string(camera_, "TriggerSource", "Line0", e);
    if (*e == nullptr && has_entry(camera_, "TriggerActivation", "RisingEdge")) {
      arv_camera_set_string(camera_, "TriggerActivation", "RisingEdge", e);
    }
  });
}

Result<void> GigeCamera::configure_region() {
  gint sensor_width = 0;
  gint sensor_height = 0;
  Result<void> done = step(config_, ResultCode::kCameraLost, "sensor size",
                           [&](GError** e) { arv_camera_get_sensor_size(camera_, &sensor_width, &sensor_height, e); });
  if (!done) return done;
  facts_.sensor_width = sensor_width;
  facts_.sensor_height = sensor_height;
  if (sensor_width < config_.width || sensor_height < config_.height) {
    return failure(ResultCode::kFrameWrongSize,
                   "camera %s: expected a sensor of at least %dx%d, found %dx%d; correct the configured size",
                   config_.name(), config_.width, config_.height, sensor_width, sensor_height);
  }
  return step(config_, ResultCode::kCameraLost, "region and pixel format", [&](GError** e) {
    arv_camera_set_region(camera_, -1, -1, config_.width, config_.height, e);
    if (*e == nullptr) arv_camera_set_pixel_format(camera_, ARV_PIXEL_FORMAT_MONO_8, e);
  });
}

Result<void> GigeCamera::configure_exposure() {
  try_step([&](GError** e) {
    if (arv_camera_is_exposure_auto_available(camera_, e)) arv_camera_set_exposure_time_auto(camera_, ARV_AUTO_OFF, e);
  });
  try_step([&](GError** e) {
    if (arv_camera_is_gain_auto_available(camera_, e)) arv_camera_set_gain_auto(camera_, ARV_AUTO_OFF, e);
  });
  facts_.trigger_width = has_entry(camera_, "ExposureMode", "TriggerWidth");
  if (facts_.trigger_width) {
    return step(config_, ResultCode::kCameraLost, "exposure mode",
                [&](GError** e) { arv_camera_set_string(camera_, "ExposureMode", "TriggerWidth", e); });
  }
  try_step([&](GError** e) { arv_camera_set_string(camera_, "ExposureMode", "Timed", e); });
  return step(config_, ResultCode::kCameraLost, "exposure time",
              [&](GError** e) { arv_camera_set_exposure_time(camera_, config_.timed_exposure_us, e); });
}

Result<void> GigeCamera::start_stream(std::span<std::uint8_t> memory) {
  arv_camera_gv_set_stream_options(
      camera_, config_.packet_socket ? ARV_GV_STREAM_OPTION_NONE : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  Result<void> done = step(config_, ResultCode::kCameraLost, "stream", [&](GError** e) {
    stream_ = arv_camera_create_stream(camera_, prepare_thread, nullptr, e);
  });
  if (!done) return done;
  set_stream_options();
  try_step([&](GError** e) { facts_.packet_bytes = static_cast<int>(arv_camera_gv_get_packet_size(camera_, e)); });
  const std::size_t frame_bytes = memory.size() / static_cast<std::size_t>(config_.buffers);
  for (int i = 0; i < config_.buffers; ++i) {
    arv_stream_push_buffer(stream_,
                           arv_buffer_new(frame_bytes, memory.data() + static_cast<std::size_t>(i) * frame_bytes));
  }
  return step(config_, ResultCode::kCameraLost, "start", [&](GError** e) { arv_camera_start_acquisition(camera_, e); });
}

void GigeCamera::set_stream_options() {
  g_object_set(stream_, "packet-resend", ARV_GV_STREAM_PACKET_RESEND_ALWAYS, "packet-timeout", kPacketTimeoutUs,
               "frame-retention", kFrameRetentionUs, "packet-request-ratio", kResendShare, nullptr);
  enlarge_receive_buffer(arv_gv_stream_get_port(ARV_GV_STREAM(stream_)), kStreamSocketBytes);
}

std::optional<Frame> GigeCamera::wait_frame(std::int64_t timeout_us) {
  ArvBuffer* buffer = timeout_us > 0 ? arv_stream_timeout_pop_buffer(stream_, static_cast<guint64>(timeout_us))
                                     : arv_stream_try_pop_buffer(stream_);
  if (buffer == nullptr) return std::nullopt;
  Frame frame;
  frame.buffer = buffer;
  frame.frame_id = arv_buffer_get_frame_id(buffer);
  frame.code = code_of(arv_buffer_get_status(buffer));
  if (frame.code != ResultCode::kOk) return frame;
  size_t bytes = 0;
  const void* data = arv_buffer_get_data(buffer, &bytes);
  const bool is_image = arv_buffer_get_payload_type(buffer) == ARV_BUFFER_PAYLOAD_TYPE_IMAGE;
  if (!is_image || arv_buffer_get_image_width(buffer) != config_.width ||
      arv_buffer_get_image_height(buffer) != config_.height ||
      arv_buffer_get_image_pixel_format(buffer) != ARV_PIXEL_FORMAT_MONO_8) {
    frame.code = ResultCode::kFrameWrongSize;
    return frame;
  }
  frame.image = {static_cast<const std::uint8_t*>(data), config_.height, config_.width};
  return frame;
}

void GigeCamera::requeue(const Frame& frame) { arv_stream_push_buffer(stream_, static_cast<ArvBuffer*>(frame.buffer)); }

}  // namespace beltpick::capture
