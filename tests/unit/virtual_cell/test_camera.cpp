// The virtual camera against Aravis, an implementation of GigE Vision that is not ours.
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>
#include <vector>

#include "aravis_client.hpp"
#include "base/clock.hpp"
#include "virtual_cell/gige/camera.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell::gige;
using namespace std::chrono_literals;
using beltpick::test::AravisClient;

namespace {

constexpr const char* kAddress = "127.0.7.1";
constexpr int kWidth = 640;
constexpr int kHeight = 480;

// The camera paints the trigger's number into every pixel.
std::unique_ptr<Camera> open_device(std::atomic<int>* strobes = nullptr) {
  CameraSettings settings;
  settings.identity = {"BPTEST1", kWidth, kHeight};
  settings.address = kAddress;
  settings.fill = [](ImageView<std::uint8_t> image, const Exposure& exposure) {
    std::fill(image.data, image.data + image.size(), static_cast<std::uint8_t>(exposure.trigger_number + 1));
  };
  if (strobes != nullptr) settings.exposure_began = [strobes](const Exposure&) { ++*strobes; };
  auto device = Camera::open(std::move(settings));
  REQUIRE(device);
  return std::move(*device);
}

void pulse(Camera& device, std::chrono::microseconds width, std::chrono::microseconds period) {
  const auto start = std::chrono::steady_clock::now();
  device.line_edge(true, monotonic_us());
  std::this_thread::sleep_for(width);
  device.line_edge(false, monotonic_us());
  std::this_thread::sleep_until(start + period);
}

struct Received {
  std::vector<int> values;  // the pixel value of each whole frame
  std::vector<guint64> ids;
  std::vector<ArvBufferStatus> broken;
};

Received receive(AravisClient& client, int frames, std::chrono::milliseconds patience = 1500ms) {
  Received received;
  for (int i = 0; i < frames; ++i) {
    ArvBuffer* buffer =
        arv_stream_timeout_pop_buffer(client.stream, static_cast<guint64>(std::chrono::microseconds(patience).count()));
    if (buffer == nullptr) break;
    if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) {
      std::size_t size = 0;
      const auto* pixels = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
      received.values.push_back(std::all_of(pixels, pixels + size, [&](auto p) { return p == pixels[0]; }) ? pixels[0]
                                                                                                           : -1);
      received.ids.push_back(arv_buffer_get_frame_id(buffer));
    } else {
      received.broken.push_back(arv_buffer_get_status(buffer));
    }
    g_object_unref(buffer);
  }
  return received;
}

}  // namespace

TEST_CASE("22 frames at 60 Hz arrive whole, in order, across the wrap of the frame ids") {
  std::atomic<int> strobes{0};
  const auto device = open_device(&strobes);
  AravisClient client(kAddress);
  CHECK(std::string(arv_camera_get_device_serial_number(client.camera, nullptr)) == "BPTEST1");
  for (int i = 0; i < 22; ++i) pulse(*device, 4000us, 16667us);
  const Received received = receive(client, 22);
  REQUIRE(received.values.size() == 22);
  for (int i = 0; i < 22; ++i) CHECK(received.values[i] == i + 1);
  CHECK(received.ids.front() == 65530);
  CHECK(received.ids.back() < 65530);
  CHECK(strobes == 22);
}

TEST_CASE("lost packets are sent again on request") {
  const auto device = open_device();
  AravisClient client(kAddress);
  device->set_packet_loss(0.02);
  for (int i = 0; i < 22; ++i) pulse(*device, 2000us, 16667us);
  const Received received = receive(client, 22);
  CHECK(received.values.size() == 22);
  CHECK(device->counters().dropped > 0);
  CHECK(device->counters().resent >= device->counters().dropped);
}

TEST_CASE("frame faults: lost, short, wrong size, black, duplicated, missed trigger") {
  const auto device = open_device();
  AravisClient client(kAddress);
  device->inject(FrameFault::kLoseFrame, 1);
  device->inject(FrameFault::kShortFrame, 3);
  device->inject(FrameFault::kWrongSize, 5);
  device->inject(FrameFault::kBlack, 7);
  device->inject(FrameFault::kDuplicate, 9);
  device->inject(FrameFault::kMissTrigger, 11);
  for (int i = 0; i < 13; ++i) pulse(*device, 2000us, 30000us);
  const Received received = receive(client, 11, 800ms);
  // Aravis takes the frame of fewer rows as a success of fewer bytes or as broken: the client has to look at its size.
  CHECK(received.values.size() + received.broken.size() == 11);
  CHECK(!received.broken.empty());
  const std::vector<int>& values = received.values;
  CHECK(std::count(values.begin(), values.end(), 2) == 0);
  CHECK(std::count(values.begin(), values.end(), 4) == 0);
  CHECK(std::count(values.begin(), values.end(), 0) == 1);
  CHECK(std::count(values.begin(), values.end(), 9) == 2);
  CHECK(values.back() == 12);  // the missed trigger used no number
}

TEST_CASE("a second client gets no control; a write may be announced as pending") {
  const auto device = open_device();
  AravisClient client(kAddress);
  CHECK(arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(client.camera))));
  ArvCamera* other = arv_camera_new(kAddress, nullptr);
  if (other != nullptr) {
    CHECK_FALSE(arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(other))));
    g_object_unref(other);
  }
  device->set_write_delay_ms(700);  // longer than Aravis waits for an answer that was not announced
  GError* error = nullptr;
  arv_camera_set_float(client.camera, "ExposureTime", 1234.0, &error);
  CHECK(error == nullptr);
  g_clear_error(&error);
  device->set_write_delay_ms(0);
  CHECK(arv_camera_get_float(client.camera, "ExposureTime", nullptr) == Approx(1234.0));
}

TEST_CASE("a vanished camera is noticed, and serves again after it came back") {
  const auto device = open_device();
  {
    AravisClient client(kAddress);
    pulse(*device, 2000us, 16667us);
    CHECK(receive(client, 1).values.size() == 1);
    device->die();
    for (int i = 0; i < 100 && !client.lost; ++i) std::this_thread::sleep_for(100ms);
    CHECK(client.lost);
    CHECK_FALSE(device->acquiring());
  }
  device->revive();
  AravisClient client(kAddress);
  pulse(*device, 2000us, 16667us);
  CHECK(receive(client, 1).values.size() == 1);
}

TEST_CASE("a client that falls silent loses control and the stream stops") {
  const auto device = open_device();
  AravisClient client(kAddress);
  REQUIRE(device->acquiring());
  constexpr guint64 kHeartbeatTimeoutRegister = 0x0938;
  REQUIRE(arv_device_write_register(arv_camera_get_device(client.camera), kHeartbeatTimeoutRegister, 300, nullptr));
  // Aravis beats every second: slower than the time-out asked for here, as if the client hung.
  for (int i = 0; i < 30 && device->acquiring(); ++i) std::this_thread::sleep_for(100ms);
  CHECK_FALSE(device->acquiring());
}
