// Camera: a GigE Vision camera of our own on a loopback address: registers, control and stream channel, a sensor that
// is exposed by edges of a trigger line, and the faults real cameras and networks have.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/image.hpp"
#include "base/result.hpp"
#include "virtual_cell/gige/control_channel.hpp"
#include "virtual_cell/gige/register_bank.hpp"
#include "virtual_cell/gige/sensor.hpp"
#include "virtual_cell/gige/stream_channel.hpp"

namespace beltpick::virtual_cell::gige {

// What happens to one frame.
enum class FrameFault : std::uint8_t {
  kMissTrigger,  // the sensor does not react: no exposure, no strobe, no frame id used
  kLoseFrame,    // exposed, but no packet of it arrives
  kShortFrame,   // the last third of its packets is missing and cannot be resent
  kWrongSize,    // half its rows, as if the region of interest had changed
  kBlack,
  kDuplicate,  // the previous image again
};

struct CameraSettings {
  CameraIdentity identity;
  std::string address = "127.0.0.1";     // to listen on, port 3956
  std::uint16_t first_block_id = 65530;  // near the wrap of the 16-bit frame ids
  double bytes_per_second = 118e6;       // of the stream: gigabit Ethernet
  // Makes the image of an exposure, sensor size; called in the readout thread.
  std::function<void(ImageView<std::uint8_t>, const Exposure&)> fill;
  // The exposure strobe, in the thread of the edge; the end of a Timed exposure in a thread of the camera.
  std::function<void(const Exposure&)> exposure_began;
  std::function<void(const Exposure&)> exposure_ended;
};

class Camera {
 public:
  // kServiceUnreachable: the address is wrong or its port 3956 is taken.
  static Result<std::unique_ptr<Camera>> open(CameraSettings settings);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  // An edge of Line0 at a time of monotonic_us(), not decreasing.
  void line_edge(bool rising, std::int64_t time_us);

  // Faults. A frame fault hits the frame after `frames_ahead` further ones.
  void inject(FrameFault fault, int frames_ahead = 0);
  void set_packet_loss(double share) { packet_loss_ = share; }
  void set_write_delay_ms(int delay_ms) { control_->set_write_delay_ms(delay_ms); }
  void die();
  void revive();  // as after power came back: registers at their defaults, nobody in control

  [[nodiscard]] bool acquiring() const { return acquiring_; }
  [[nodiscard]] std::uint32_t edges_while_exposing() const;
  [[nodiscard]] const StreamChannel::Counters& counters() const { return stream_->counters(); }

 private:
  Camera(CameraSettings settings, std::uint32_t ip);

  void register_written(std::uint32_t at, std::uint32_t value);
  void configure_sensor();
  void stop_acquisition();
  struct Shot {
    Exposure exposure;
    std::optional<FrameFault> fault;
  };

  std::optional<FrameFault> take_fault();
  void run_exposures();
  void run_readout();
  bool take(std::deque<Shot>& from, Shot& shot);
  void read_out(const Shot& shot);
  std::shared_ptr<StreamFrame> make_frame(const Shot& shot);
  [[nodiscard]] StreamDestination destination() const;

  CameraSettings settings_;
  RegisterBank bank_;
  std::unique_ptr<StreamChannel> stream_;
  std::unique_ptr<ControlChannel> control_;
  std::atomic<bool> acquiring_{false};
  std::atomic<bool> dead_{false};
  std::atomic<double> packet_loss_{0.0};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  Sensor sensor_;
  std::deque<Shot> exposing_;                   // Timed: their end lies ahead
  std::deque<Shot> exposed_;                    // to be read out
  std::map<std::uint64_t, FrameFault> faults_;  // by the number of the edge, counted over the camera's life
  std::uint64_t edges_ = 0;
  std::optional<FrameFault> current_fault_;  // of the exposure that is open
  bool stop_ = false;

  std::vector<std::uint8_t> image_;  // sensor size; of the readout thread
  std::uint16_t block_id_;
  std::thread exposure_;
  std::thread readout_;
};

}  // namespace beltpick::virtual_cell::gige
