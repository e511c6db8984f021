#include "virtual_cell/world/live_world.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kBeltTravel_s = 0.6;  // from one stop to the next
constexpr double kRobotApproach_s = 0.3;
constexpr double kRobotRetreat_s = 0.2;
constexpr double kBeltSpeed_mm_s = 20.0;  // of a belt that moves when it must not
constexpr double kBeltSlip_mm = 15.0;     // how far it gets at most
constexpr double kPacketLoss = 0.01;
constexpr double kLineNoise = 0.01;   // of the serial line's bytes, on a bad cable
constexpr double kLineGarble = 0.25;  // and on one over which nothing comes whole

}  // namespace

Result<std::unique_ptr<LiveWorld>> LiveWorld::start(LiveWorldSettings settings) {
  if (settings.sequence.frames.empty()) {
    return failure(ResultCode::kSequenceUndecodable, "virtual cell: the projector's sequence has no frames");
  }
  std::unique_ptr<LiveWorld> world(new LiveWorld(std::move(settings)));
  if (auto up = world->power_up(); !up) return std::unexpected(up.error());
  return world;
}

LiveWorld::LiveWorld(LiveWorldSettings settings)
    : settings_(std::move(settings)),
      truth_(settings_.parts, settings_.rig),
      projector_(settings_.sequence),
      random_(settings_.seed, 0x11fe),
      renderer_(settings_.rig, settings_.parts, settings_.render),
      belt_changed_us_(monotonic_us()),
      camera_line_([this](bool level, std::int64_t at_us) { camera_->line_edge(level, at_us); }),
      projector_line_([this](bool level, std::int64_t) {
        if (level) projector_.advance();
      }),
      strobe_line_([this](bool level, std::int64_t) {
        if (board_ != nullptr) board_->set_strobe(level);
      }) {}

Result<void> LiveWorld::power_up() {
  place();
  gige::CameraSettings camera;
  camera.identity = {settings_.camera_serial, settings_.rig.camera.width, settings_.rig.camera.height};
  camera.address = settings_.camera_address;
  camera.fill = [this](ImageView<std::uint8_t> image, const gige::Exposure& exposure) { fill(image, exposure); };
  camera.exposure_began = [this](const gige::Exposure& exposure) { on_exposure_began(exposure); };
  camera.exposure_ended = [this](const gige::Exposure& exposure) { strobe_line_.drive(false, exposure.end_us); };
  auto opened = gige::Camera::open(std::move(camera));
  if (!opened) return std::unexpected(opened.error());
  camera_ = std::move(*opened);
  auto board = make_trigger_board(settings_.board, settings_.trigger_link,
                                  [this](const host::PinEdge& edge) { on_board_edge(edge); });
  if (!board) return std::unexpected(board.error());
  board_ = std::move(*board);
  return {};
}

void LiveWorld::on_board_edge(const host::PinEdge& edge) {
  if (edge.pin == host::Pin::kBusy && edge.level) projector_.rewind();
  if (edge.pin == host::Pin::kProjectorAdvance) projector_line_.drive(edge.level, edge.at_ns / 1000);
  if (edge.pin != host::Pin::kCameraTrigger) return;
  if (edge.level) {
    pulse_rise_us_ = edge.at_ns / 1000;
    pulse_rise_board_us_ = edge.board_us;
  }
  // The pulse is as long as the board made it, however late this thread was.
  camera_line_.drive(edge.level, pulse_rise_us_ + (edge.board_us - pulse_rise_board_us_));
}

void LiveWorld::on_exposure_began(const gige::Exposure& exposure) {
  strobe_line_.drive(true, exposure.start_us);
  ++exposures_;
  const std::scoped_lock lock(belt_mutex_);
  const double since_stop_s = belt_moving_ ? 0.0 : static_cast<double>(exposure.start_us - belt_changed_us_) * 1e-6;
  moments_[exposure.trigger_number] = {projector_.shown(), since_stop_s, travelled_mm(exposure.start_us)};
}

void LiveWorld::fill(ImageView<std::uint8_t> image, const gige::Exposure& exposure) {
  Moment moment;
  {
    const std::scoped_lock lock(belt_mutex_);
    if (auto found = moments_.extract(exposure.trigger_number); !found.empty()) moment = found.mapped();
  }
  FrameSpec dark;
  dark.kind = FrameKind::kBlack;
  const std::scoped_lock lock(render_mutex_);
  renderer_.expose(moment.pattern != nullptr ? *moment.pattern : dark, exposure.duration_us(), moment.since_stop_s,
                   image, moment.travelled_mm);
}

void LiveWorld::photograph(ImageView<std::uint8_t> image) {
  FrameSpec white;
  white.kind = FrameKind::kWhite;
  const std::scoped_lock lock(render_mutex_);
  renderer_.expose(white, settings_.render.nominal_exposure_us, 10.0, image);
}

void LiveWorld::place() {
  const std::scoped_lock lock(render_mutex_);
  renderer_.place(truth_.instances(), settings_.seed * 1000 + next_view_);
}

bool LiveWorld::bring_next_parts() {
  wait_s(kBeltTravel_s);
  if (next_view_ >= settings_.views.size()) {
    truth_.set({});
    return false;
  }
  truth_.set(settings_.views[next_view_++]);
  place();
  const std::scoped_lock lock(belt_mutex_);
  belt_moving_ = false;  // before its line says so, as with a real brake
  belt_changed_us_ = monotonic_us();
  return true;
}

double LiveWorld::travelled_mm(std::int64_t now_us) const {
  if (!belt_moving_) return 0.0;
  return std::clamp(static_cast<double>(now_us - belt_changed_us_) * 1e-6 * kBeltSpeed_mm_s, 0.0, kBeltSlip_mm);
}

void LiveWorld::set_belt_stopped_line(bool stopped) {
  board_->set_belt_stopped(stopped);
  double slipped_mm = 0.0;
  {
    const std::scoped_lock lock(belt_mutex_);
    if (belt_moving_ == !stopped) return;
    const std::int64_t now_us = monotonic_us();
    slipped_mm = travelled_mm(now_us);
    belt_moving_ = !stopped;
    belt_changed_us_ = now_us;
  }
  constexpr double kWorthMoving_mm = 0.05;
  if (slipped_mm < kWorthMoving_mm) return;
  truth_.shift(slipped_mm);
  place();
}

void LiveWorld::set_emergency_stop_line(bool pressed) { board_->set_emergency_stop(pressed); }

PickResult LiveWorld::pick(const Offer& offer) {
  wait_s(kRobotApproach_s);
  const PickJudgement judged = truth_.judge(offer);
  if (judged.outcome == PickOutcome::kPicked) {
    truth_.remove(judged.index);
    place();
  }
  wait_s(kRobotRetreat_s);
  return judged;
}

void LiveWorld::miss() { wait_s(kRobotApproach_s + kRobotRetreat_s); }

int LiveWorld::parts_in_view() const { return static_cast<int>(truth_.parts().size()); }

// A phase frame that follows one of the same kind: its loss or doubling must be noticed by what it shows.
int LiveWorld::frame_to_break(CellFault fault) {
  const auto& frames = settings_.sequence.frames;
  std::vector<int> fit;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const bool telling = frames[i].kind == FrameKind::kPhase && frames[i - 1].kind == FrameKind::kPhase;
    if (telling) fit.push_back(static_cast<int>(i));
  }
  const bool any = fit.empty() || fault == CellFault::kLostFrame || fault == CellFault::kMissedTrigger;
  const auto choices = static_cast<std::uint32_t>(any ? frames.size() : fit.size());
  const std::scoped_lock lock(random_mutex_);
  const auto drawn = random_.below(std::max(choices, 1U));
  return any ? static_cast<int>(drawn) : fit[drawn];
}

void LiveWorld::break_device(CellFault fault) {
  using gige::FrameFault;
  switch (fault) {
    case CellFault::kLostPackets:
      camera_->set_packet_loss(kPacketLoss);
      break;
    case CellFault::kLostFrame:
      camera_->inject(FrameFault::kLoseFrame, frame_to_break(fault));
      break;
    case CellFault::kMissedTrigger:
      camera_->inject(FrameFault::kMissTrigger, frame_to_break(fault));
      break;
    case CellFault::kShortFrame:
      camera_->inject(FrameFault::kShortFrame, frame_to_break(fault));
      break;
    case CellFault::kWrongSize:
      camera_->inject(FrameFault::kWrongSize, frame_to_break(fault));
      break;
    case CellFault::kBlackFrame:
      camera_->inject(FrameFault::kBlack, frame_to_break(fault));
      break;
    case CellFault::kDuplicateFrame:
      camera_->inject(FrameFault::kDuplicate, frame_to_break(fault));
      break;
    case CellFault::kDeadCamera:
      camera_->die();
      break;
    default:
      break_wire(fault);
  }
}

// The trigger board, and the wires from and to it.
void LiveWorld::break_wire(CellFault fault) {
  switch (fault) {
    case CellFault::kNoStrobe:
      strobe_line_.stick_at(false);
      break;
    case CellFault::kStrobeStuck:
      strobe_line_.stick_at(true);
      break;
    case CellFault::kTriggerCut:
      camera_line_.stick_at(false);
      break;
    case CellFault::kTriggerStuck:
      camera_line_.stick_at(true);
      break;
    case CellFault::kLostAdvance:
      projector_line_.lose_pulse(frame_to_break(fault));
      break;
    case CellFault::kHungFirmware:
      board_->hang();
      break;
    case CellFault::kUartNoise:
      board_->set_line_noise(kLineNoise);
      break;
    case CellFault::kUartGarbled:
      board_->set_line_noise(kLineGarble);
      break;
    case CellFault::kUartCut:
      board_->cut_line(true);
      break;
    default:
      break;
  }
}

void LiveWorld::mend_devices() {
  camera_->set_packet_loss(0.0);
  camera_->revive();
  for (Wire* wire : {&camera_line_, &projector_line_, &strobe_line_}) wire->mend();
  board_->set_line_noise(0.0);
  board_->cut_line(false);
}

void LiveWorld::wait_s(double seconds) const {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds / settings_.speed));
}

}  // namespace beltpick::virtual_cell
