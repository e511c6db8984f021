// LiveWorld: the whole cell without hardware, in real time: belt and parts, projector, camera and trigger board, wired
// as README.md shows. Its pieces talk to the appliance over the same wires as real ones: GigE Vision, a serial line,
// Modbus.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "host/pin_edge.hpp"
#include "virtual_cell/gige/camera.hpp"
#include "virtual_cell/render/belt_part.hpp"
#include "virtual_cell/render/scene_renderer.hpp"
#include "virtual_cell/world/parts_on_belt.hpp"
#include "virtual_cell/world/pattern_projector.hpp"
#include "virtual_cell/world/plant.hpp"
#include "virtual_cell/world/trigger_board.hpp"
#include "virtual_cell/world/wire.hpp"

namespace beltpick::virtual_cell {

struct LiveWorldSettings {
  Rig rig;
  std::vector<ScenePart> parts;  // in the order of the appliance's recipe
  std::vector<Scene> views;      // what the belt brings, in order
  Sequence sequence;             // stored in the projector
  RenderOptions render;
  std::uint64_t seed = 1;
  std::string camera_address = "127.0.0.1";
  std::string camera_serial = "BP0001";
  std::string trigger_link;  // where the trigger board's tty is linked to
  TriggerBoardChoice board;
  double speed = 1.0;  // of belt and robot; imaging runs in real time
};

class LiveWorld final : public Plant {
 public:
  // Powers everything up. kServiceUnreachable where an address or the pseudo-terminal is not to be had.
  static Result<std::unique_ptr<LiveWorld>> start(LiveWorldSettings settings);

  bool bring_next_parts() override;
  void set_belt_stopped_line(bool stopped) override;
  void set_emergency_stop_line(bool pressed) override;
  PickResult pick(const Offer& offer) override;
  void miss() override;
  [[nodiscard]] int parts_in_view() const override;
  [[nodiscard]] int exposures() const override { return exposures_; }
  void break_device(CellFault fault) override;
  void mend_devices() override;

  [[nodiscard]] std::string trigger_tty() const { return board_->tty(); }
  // The view as the camera sees it under the projector's white.
  void photograph(ImageView<std::uint8_t> image);

 private:
  // What stood when an exposure began; the image is made later, in the camera's readout.
  struct Moment {
    const FrameSpec* pattern = nullptr;  // null: the projector is dark
    double since_stop_s = 0.0;
    double travelled_mm = 0.0;
  };

  explicit LiveWorld(LiveWorldSettings settings);

  Result<void> power_up();
  void on_board_edge(const host::PinEdge& edge);
  void on_exposure_began(const gige::Exposure& exposure);
  void fill(ImageView<std::uint8_t> image, const gige::Exposure& exposure);
  void place();
  void wait_s(double seconds) const;
  [[nodiscard]] double travelled_mm(std::int64_t now_us) const;
  void break_wire(CellFault fault);
  [[nodiscard]] int frame_to_break(CellFault fault);

  LiveWorldSettings settings_;
  PartsOnBelt truth_;
  PatternProjector projector_;
  std::size_t next_view_ = 0;
  std::mutex random_mutex_;
  Random random_;

  std::mutex render_mutex_;
  SceneRenderer renderer_;

  mutable std::mutex belt_mutex_;  // guards what follows
  bool belt_moving_ = false;
  std::int64_t belt_changed_us_ = 0;         // when it began to move, or came to stand
  std::map<std::uint32_t, Moment> moments_;  // by trigger number

  std::atomic<int> exposures_{0};
  std::int64_t pulse_rise_us_ = 0;  // of the board's thread
  std::uint32_t pulse_rise_board_us_ = 0;
  std::unique_ptr<gige::Camera> camera_;
  Wire camera_line_;                     // the trigger, to the camera
  Wire projector_line_;                  // the advance, to the projector
  Wire strobe_line_;                     // of the camera, to the board
  std::unique_ptr<TriggerBoard> board_;  // its threads call into all of the above: destroyed first
};

}  // namespace beltpick::virtual_cell
