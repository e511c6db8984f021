// A client of the virtual camera through Aravis, opened, set to Line0 and TriggerWidth, and acquiring.
#pragma once

#include <arv.h>

#include <atomic>
#include <catch2/catch.hpp>

namespace beltpick::test {

struct AravisClient {
  ArvCamera* camera = nullptr;
  ArvStream* stream = nullptr;
  std::atomic<bool> lost{false};

  explicit AravisClient(const char* address, int buffers = 30) {
    GError* error = nullptr;
    camera = arv_camera_new(address, &error);
    if (camera == nullptr) FAIL("no camera: " << (error != nullptr ? error->message : "?"));
    g_signal_connect(arv_camera_get_device(camera), "control-lost", G_CALLBACK(&AravisClient::on_lost), this);
    arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    set("TriggerSelector", "FrameStart");
    set("TriggerMode", "On");
    set("TriggerSource", "Line0");
    set("ExposureMode", "TriggerWidth");
    arv_camera_gv_set_packet_size(camera, 8000, nullptr);
    stream = arv_camera_create_stream(camera, nullptr, nullptr, &error);
    REQUIRE(stream != nullptr);
    g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", 2'000'000, nullptr);
    const auto payload = arv_camera_get_payload(camera, nullptr);
    for (int i = 0; i < buffers; ++i) arv_stream_push_buffer(stream, arv_buffer_new(payload, nullptr));
    arv_camera_start_acquisition(camera, &error);
    REQUIRE(error == nullptr);
  }
  ~AravisClient() {
    g_clear_object(&stream);
    g_clear_object(&camera);
  }
  void set(const char* feature, const char* value) {
    GError* error = nullptr;
    arv_camera_set_string(camera, feature, value, &error);
    if (error != nullptr) FAIL(feature << ": " << error->message);
  }
  static void on_lost(ArvDevice*, AravisClient* self) { self->lost = true; }
};

}  // namespace beltpick::test
