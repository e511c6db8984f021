#include "device_world.hpp"

#include "check.hpp"

namespace fuzz {

using namespace beltpick;
using protocol::Refusal;
using protocol::State;
using protocol::Type;

namespace {

constexpr std::uint8_t kBeltStands = protocol::kInputBeltStopped;

// As the AVR boards have them.
core::BoardTiming board_timing() {
  core::BoardTiming board;
  board.start_lead_us = 1000;
  board.late_limit_us = 20000;
  board.min_interval_us = 50;
  board.min_exposure_us = 50;
  board.min_period_us = 500;
  return board;
}

protocol::Identity identity(Input& input) {
  protocol::Identity identity;
  identity.reset_cause = input.u8() & 15U;
  identity.flash_state = input.u8() == 0xD0 ? protocol::FlashState::kDamaged : protocol::FlashState::kWhole;
  return identity;
}

bool before(std::uint32_t a_ticks, std::uint32_t b_ticks) { return static_cast<std::int32_t>(a_ticks - b_ticks) < 0; }

}  // namespace

World::World(Input& input)
    : now_ticks_(input.u32()),
      program_damaged_(false),
      device_(identity(input), input.u8() & 3U, now_ticks_, board_timing()) {
  program_damaged_ = status().fault == protocol::Fault::kFlashDamaged;
  check();
}

void World::step(Input& input) {
  const std::uint8_t what = input.u8();
  switch (what % 12) {
    case 0:
      device_.on_byte(input.u8(), now_ticks_);
      break;
    case 1:
      send(input);
      break;
    case 2:
      send_arm(input);
      break;
    case 3:
      post(Type::kStart, protocol::Start{what < 128 ? arm_id_ : input.u16()});
      break;
    case 4:
      let_pass(input.u8() * 64U);
      break;
    case 5:
      let_pass(input.u16() * 8U);
      break;
    case 6:
      what < 128 ? jump(input.u16()) : jump(input.u32());
      break;
    case 7:
      set_strobe(what < 128);
      break;
    case 8:
      camera_answers_ = what < 192;
      break;
    case 9:
      set_inputs(what < 192 ? kBeltStands : input.u8() & 3U);
      break;
    case 10:
      what < 192 ? static_cast<void>(sequencer().start_by_pin(now_ticks_)) : sequencer().on_late_edge();
      break;
    default:
      listen();
  }
  check();
}

// A message that is whole, whatever it says.
void World::send(Input& input) {
  constexpr Type kSimple[] = {Type::kIdentify, Type::kAbort,     Type::kClear,
                              Type::kStatus,   Type::kKeepalive, Type::kEnterLoader};
  const std::uint8_t which = input.u8();
  if (which < 192) return post(kSimple[which % 6], protocol::Empty());
  std::uint8_t message[protocol::kMaxMessage];
  const std::size_t size = 1 + input.u8() % sizeof message;
  for (std::size_t i = 0; i < size; ++i) message[i] = input.u8();
  if (which < 240) message[0] = protocol::kVersion;
  std::uint8_t frame[protocol::kMaxFrame];
  const std::size_t length = protocol::encode_frame(message, size, frame, sizeof frame);
  for (std::size_t i = 0; i < length; ++i) device_.on_byte(frame[i], now_ticks_);
}

// Times near what can be run: of any numbers hardly one sequence would be taken.
void World::send_arm(Input& input) {
  protocol::Arm arm;
  const std::uint8_t shape = input.u8();
  arm.arm_id = (shape & 1U) != 0 ? arm_id_ : ++arm_id_;
  arm.host_silence_ms = (shape & 2U) != 0 ? input.u16() : std::uint16_t{60000};
  arm.strobe_tolerance_us = (shape & 4U) != 0 ? input.u16() : 200U;
  arm.group_count = static_cast<std::uint8_t>((shape & 8U) != 0 ? input.u8() : 1 + (shape >> 6U));
  for (std::uint8_t i = 0; i < arm.group_count && i < protocol::kMaxGroups; ++i) {
    protocol::Group& group = arm.groups[i];
    group.frames = 1 + (input.u8() & 7U);
    group.settle_us = 100U + input.u8() * 4U;
    group.exposure_us = 50U + input.u16() / 4U;
    group.readout_us = input.u8() * 16U;
    group.overlap_gap_us = (shape & 16U) != 0 ? input.u8() : std::uint8_t{0};
    group.period_us = group.settle_us + group.exposure_us + group.readout_us + input.u8() * 8U;
    if ((shape & 32U) != 0) group.period_us = input.u32();
  }
  post(Type::kArm, arm);
}

template <class Payload>
void World::post(Type type, const Payload& payload) {
  std::uint8_t frame[protocol::kMaxFrame];
  const std::size_t length = protocol::encode(type, ++sequence_, payload, frame, sizeof frame);
  for (std::size_t i = 0; i < length; ++i) device_.on_byte(frame[i], now_ticks_);
}

// Every deadline at its time, as a board does that keeps up; the camera answers each pulse at once.
void World::let_pass(std::uint32_t ticks) {
  const std::uint32_t until_ticks = now_ticks_ + ticks;
  std::uint32_t due_ticks = 0;
  while (sequencer().next_deadline(due_ticks) && !before(until_ticks, due_ticks)) {
    if (before(now_ticks_, due_ticks)) now_ticks_ = due_ticks;
    sequencer().on_time(now_ticks_);
    check();
    if (camera_answers_) set_strobe(sequencer().outputs().camera);
    listen();
  }
  now_ticks_ = until_ticks;
}

// A board that was busy elsewhere.
void World::jump(std::uint32_t ticks) {
  clock_jumped_ = true;
  now_ticks_ += ticks;
  sequencer().on_time(now_ticks_);
}

void World::set_inputs(std::uint8_t bits) { sequencer().on_inputs(bits, now_ticks_); }

void World::set_strobe(bool level) {
  sequencer().on_strobe(level, now_ticks_);
  check();
}

// The host's end: whatever the device says is whole and of its version.
void World::listen() {
  std::uint8_t byte = 0;
  while (device_.next_byte(byte)) {
    const auto outcome = host_.push(byte);
    FUZZ_CHECK(outcome != protocol::FrameDecoder::Outcome::kDamaged);
    if (outcome == protocol::FrameDecoder::Outcome::kMessage) take_message();
  }
}

void World::take_message() {
  protocol::Header header;
  FUZZ_CHECK(protocol::decode_header(host_.message(), host_.size(), header));
  FUZZ_CHECK(header.version == protocol::kVersion);
  const auto read = [&](auto payload) {
    FUZZ_CHECK(protocol::decode_payload(host_.message(), host_.size(), payload));
    return payload;
  };
  switch (header.type) {
    case Type::kReply:
      reached_.refusals += read(protocol::Reply()).refusal != Refusal::kNone ? 1 : 0;
      return;
    case Type::kIdentity:
      read(protocol::Identity());
      return;
    case Type::kStatusReport:
      read(protocol::StatusReport());
      return;
    case Type::kFrameEvent:
      FUZZ_CHECK(read(protocol::FrameEvent()).frame < protocol::kMaxFrames);
      return;
    case Type::kDoneEvent:
      ++reached_.done;
      FUZZ_CHECK(read(protocol::DoneEvent()).frames > 0);
      return;
    case Type::kFaultEvent:
      ++reached_.faults;
      FUZZ_CHECK(read(protocol::FaultEvent()).fault != protocol::Fault::kNone);
      return;
    default:
      FUZZ_CHECK(header.type == Type::kInputsEvent);
      read(protocol::InputsEvent());
  }
}

void World::check() {
  const core::Outputs out = sequencer().outputs();
  const protocol::StatusReport now = status();
  const bool running = now.state == State::kRunning;
  FUZZ_CHECK(out.busy == running);
  FUZZ_CHECK(out.done == (now.state == State::kDone));
  FUZZ_CHECK(out.fault == (now.state == State::kFault));
  FUZZ_CHECK(out.fault == (now.fault != protocol::Fault::kNone));
  FUZZ_CHECK(running || (!out.camera && !out.projector));
  FUZZ_CHECK(!(out.camera && out.projector));
  FUZZ_CHECK((now.inputs & protocol::kInputEmergencyStop) == 0 || out.fault);
  FUZZ_CHECK((now.inputs & protocol::kInputBeltStopped) != 0 || !running);
  FUZZ_CHECK(!program_damaged_ || now.fault == protocol::Fault::kFlashDamaged);
  std::uint32_t due_ticks = 0;
  FUZZ_CHECK(sequencer().next_deadline(due_ticks) == running);
  if (running && !was_running_) {
    ++reached_.running;
    check_edges_of_plan();
  }
  was_running_ = running;
  if (out.camera && !pulse_rose_ticks_) {
    pulse_rose_ticks_ = now_ticks_;
    clock_jumped_ = false;
  }
  if (!out.camera && pulse_rose_ticks_) {
    FUZZ_CHECK(clock_jumped_ || now_ticks_ - *pulse_rose_ticks_ <= core::ticks_of(protocol::kMaxExposure_us));
    pulse_rose_ticks_.reset();
  }
}

// A sequence that was taken has its edges in order, each pin's far enough apart, and the camera has its time.
void World::check_edges_of_plan() const {
  const protocol::Arm& plan = device_.sequencer().plan();
  const std::uint32_t least_ticks = core::ticks_of(board_timing().min_interval_us);
  core::EdgeWalk walk;
  walk.start(0);
  std::uint32_t last_ticks = 0;
  std::optional<std::uint32_t> rise_ticks, fall_ticks;
  std::uint16_t frames = 0;
  for (; walk.edge() != core::Edge::kSequenceEnds; walk.pass(plan)) {
    const std::uint32_t at_ticks = walk.at_ticks();
    FUZZ_CHECK(!before(at_ticks, last_ticks));
    last_ticks = at_ticks;
    if (walk.edge() == core::Edge::kFrameBegins) ++frames;
    if (walk.edge() == core::Edge::kPulseRises) {
      FUZZ_CHECK(!fall_ticks || at_ticks - *fall_ticks >= least_ticks);
      rise_ticks = at_ticks;
    }
    if (walk.edge() == core::Edge::kPulseFalls) {
      FUZZ_CHECK(rise_ticks && at_ticks - *rise_ticks >= least_ticks);
      fall_ticks = at_ticks;
    }
  }
  FUZZ_CHECK(frames == core::total_frames(plan) && frames > 0 && frames <= protocol::kMaxFrames);
}

void World::check_way_out() {
  listen();
  set_inputs(kBeltStands);
  // A frame of the host that was cut off swallows what follows up to its end.
  device_.on_byte(0, now_ticks_);
  set_strobe(false);
  post(Type::kAbort, protocol::Empty());
  post(Type::kClear, protocol::Empty());
  check();
  if (program_damaged_) return;
  FUZZ_CHECK(status().state == State::kIdle);
  listen();
  run_a_sequence();
  FUZZ_CHECK(status().state == State::kDone);
}

void World::run_a_sequence() {
  protocol::Arm arm;
  arm.arm_id = static_cast<std::uint16_t>(status().arm_id + 1);
  if (arm.arm_id == 0) arm.arm_id = 1;
  arm.host_silence_ms = 1000;
  arm.strobe_tolerance_us = 200;
  arm.group_count = 1;
  arm.groups[0] = {3, 300, 700, 1500, 700, 0};
  post(Type::kArm, arm);
  post(Type::kStart, protocol::Start{arm.arm_id});
  check();
  FUZZ_CHECK(status().state == State::kRunning);
  camera_answers_ = true;
  let_pass(core::ticks_of(6000));
  check();
}

}  // namespace fuzz
