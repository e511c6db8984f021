// The messages between appliance and trigger microcontroller; PROTOCOL.md shows them with their timing.
//
// Every message begins with version, type and a sequence number. A request's number is the host's and comes back in the
// reply; an event carries the firmware's own count of events, so a lost one is noticed.
#pragma once

#include "protocol/bytes.hpp"
#include "protocol/faults.hpp"
#include "protocol/framing.hpp"

namespace beltpick {
namespace protocol {

// 2: measured times in ticks instead of microseconds, the gap of cameras that overlap exposure and readout, all limits
// in IDENTITY, faults 11 to 13.
constexpr uint8_t kVersion = 2;

enum class Type : uint8_t {
  // Requests of the host.
  kIdentify = 0x01,
  kArm = 0x02,
  kStart = 0x03,
  kAbort = 0x04,
  kClear = 0x05,
  kStatus = 0x06,
  kKeepalive = 0x07,
  kEnterLoader = 0x08,
  // Replies.
  kReply = 0x80,  // to ARM, START, ABORT, CLEAR, KEEPALIVE, ENTER_LOADER, and to whatever is refused
  kIdentity = 0x81,
  kStatusReport = 0x86,
  // Events.
  kFrameEvent = 0xA0,
  kDoneEvent = 0xA1,
  kFaultEvent = 0xA2,
  kInputsEvent = 0xA3,
};

enum class State : uint8_t { kIdle = 0, kArmed = 1, kRunning = 2, kDone = 3, kFault = 4 };

enum InputBit : uint8_t { kInputBeltStopped = 1U << 0U, kInputEmergencyStop = 1U << 1U };

// As the microcontroller's MCUSR has them.
enum ResetBit : uint8_t { kResetPowerOn = 1U, kResetExternal = 2U, kResetBrownOut = 4U, kResetWatchdog = 8U };

constexpr uint16_t kNoFrame = 0xFFFF;  // a fault outside any frame
constexpr uint8_t kMaxGroups = 8;
constexpr uint16_t kMaxFrames = 512;
constexpr uint32_t kMaxPeriod_us = 1000000;
constexpr uint32_t kAdvancePulse_us = 100;  // length of the projector's advance pulse; the least settle time
constexpr uint32_t kMaxExposure_us = kMaxPeriod_us - kAdvancePulse_us;

struct Header {
  uint8_t version = kVersion;
  Type type = Type::kIdentify;
  uint8_t sequence = 0;

  template <class Io>
  void fields(Io& io) {
    io.u8(version);
    io.enumerator(type);
    io.u8(sequence);
  }
};
constexpr size_t kHeaderBytes = 3;

// What the host asks for is in microseconds, what the firmware measures in ticks of IDENTITY's tick_ns.

// IDENTIFY, ABORT, CLEAR, STATUS, KEEPALIVE and ENTER_LOADER carry nothing.
struct Empty {
  template <class Io>
  void fields(Io&) {}
};

// Frames in a row with the same timing.
struct Group {
  uint16_t frames = 0;
  uint32_t settle_us = 0;    // projector advance to camera pulse
  uint32_t exposure_us = 0;  // length of the camera pulse
  uint32_t period_us = 0;    // projector advance to projector advance
  uint32_t readout_us = 0;   // what the camera needs after the end of an exposure to read it out
  // 0: the camera ignores a trigger until it has read out. Else it exposes while it reads out the frame before, and
  // needs this pause between two exposures.
  uint16_t overlap_gap_us = 0;

  // From this camera pulse to the next of its kind. No field may be longer than the longest period.
  uint32_t least_pulse_interval_us() const {
    if (overlap_gap_us == 0) return exposure_us + readout_us;
    const uint32_t exposure_and_gap_us = exposure_us + overlap_gap_us;
    return exposure_and_gap_us > readout_us ? exposure_and_gap_us : readout_us;
  }

  template <class Io>
  void fields(Io& io) {
    io.u16(frames);
    io.u32(settle_us);
    io.u32(exposure_us);
    io.u32(period_us);
    io.u32(readout_us);
    io.u16(overlap_gap_us);
  }
};

// The whole sequence. Repeating the same ARM changes nothing; another content under the same id is refused.
struct Arm {
  uint16_t arm_id = 0;
  uint16_t host_silence_ms = 0;      // longest silence of the host while the sequence runs
  uint32_t strobe_tolerance_us = 0;  // allowed between an edge of the camera pulse and the same edge of the strobe
  uint8_t group_count = 0;
  Group groups[kMaxGroups];

  template <class Io>
  void fields(Io& io) {
    io.u16(arm_id);
    io.u16(host_silence_ms);
    io.u32(strobe_tolerance_us);
    io.u8(group_count);
    for (uint8_t i = 0; i < group_count && i < kMaxGroups; ++i) groups[i].fields(io);
  }
};

struct Start {
  uint16_t arm_id = 0;

  template <class Io>
  void fields(Io& io) {
    io.u16(arm_id);
  }
};

struct Reply {
  Type request = Type::kIdentify;
  Refusal refusal = Refusal::kNone;

  template <class Io>
  void fields(Io& io) {
    io.enumerator(request);
    io.enumerator(refusal);
  }
};

// Whether the program is what the record says that was flashed with it; nobody can tell where there is no record.
enum class FlashState : uint8_t { kDamaged = 0, kWhole = 1, kUnsealed = 2 };

enum class BoardKind : uint8_t { kHost = 0, kAtmega2560 = 1, kAtmega328p = 2 };

struct Identity {
  BoardKind board = BoardKind::kHost;
  uint8_t firmware_major = 0;
  uint8_t firmware_minor = 0;
  uint8_t firmware_patch = 0;
  uint8_t max_groups = kMaxGroups;
  uint16_t max_frames = kMaxFrames;
  uint16_t tick_ns = 0;          // unit of the measured times
  uint16_t min_exposure_us = 0;  // the shortest camera pulse
  uint32_t max_exposure_us = kMaxExposure_us;
  uint16_t min_period_us = 0;
  uint32_t max_period_us = kMaxPeriod_us;
  uint16_t min_interval_us = 0;  // from one edge of a pin to its next: what the interrupts need
  uint8_t reset_cause = 0;       // ResetBit: why the firmware started
  uint16_t flash_crc = 0;        // CRC-16 of the program as it lies in the flash
  FlashState flash_state = FlashState::kUnsealed;

  template <class Io>
  void fields(Io& io) {
    io.enumerator(board);
    io.u8(firmware_major);
    io.u8(firmware_minor);
    io.u8(firmware_patch);
    io.u8(max_groups);
    io.u16(max_frames);
    io.u16(tick_ns);
    io.u16(min_exposure_us);
    io.u32(max_exposure_us);
    io.u16(min_period_us);
    io.u32(max_period_us);
    io.u16(min_interval_us);
    io.u8(reset_cause);
    io.u16(flash_crc);
    io.enumerator(flash_state);
  }
};

struct StatusReport {
  State state = State::kIdle;
  Fault fault = Fault::kNone;
  uint16_t fault_frame = kNoFrame;
  uint16_t arm_id = 0;          // of the last sequence armed; 0: none since the start
  uint16_t frames_done = 0;     // of that sequence
  uint8_t inputs = 0;           // InputBit
  uint32_t trigger_number = 0;  // camera pulses since the start
  uint32_t now_ticks = 0;       // the firmware's clock, wraps

  template <class Io>
  void fields(Io& io) {
    io.enumerator(state);
    io.enumerator(fault);
    io.u16(fault_frame);
    io.u16(arm_id);
    io.u16(frames_done);
    io.u8(inputs);
    io.u32(trigger_number);
    io.u32(now_ticks);
  }
};

// Sent when the strobe of a frame ended.
struct FrameEvent {
  uint16_t arm_id = 0;
  uint16_t frame = 0;           // from 0, in the sequence
  uint32_t trigger_number = 0;  // from 1, camera pulses since the start of the firmware
  uint32_t pulse_ticks = 0;     // rise of the camera pulse, since the first frame began
  uint32_t strobe_ticks = 0;    // rise of the strobe, likewise
  uint32_t strobe_length_ticks = 0;

  template <class Io>
  void fields(Io& io) {
    io.u16(arm_id);
    io.u16(frame);
    io.u32(trigger_number);
    io.u32(pulse_ticks);
    io.u32(strobe_ticks);
    io.u32(strobe_length_ticks);
  }
};

struct DoneEvent {
  uint16_t arm_id = 0;
  uint16_t frames = 0;
  uint32_t duration_ticks = 0;

  template <class Io>
  void fields(Io& io) {
    io.u16(arm_id);
    io.u16(frames);
    io.u32(duration_ticks);
  }
};

struct FaultEvent {
  Fault fault = Fault::kNone;
  uint16_t frame = kNoFrame;
  uint16_t arm_id = 0;

  template <class Io>
  void fields(Io& io) {
    io.enumerator(fault);
    io.u16(frame);
    io.u16(arm_id);
  }
};

// Pushed when an input changed.
struct InputsEvent {
  uint8_t inputs = 0;  // InputBit
  uint32_t now_ticks = 0;

  template <class Io>
  void fields(Io& io) {
    io.u8(inputs);
    io.u32(now_ticks);
  }
};

// The longest frame the firmware sends.
constexpr size_t kMaxOutgoingFrame = 36;

// Writes the whole frame of a message to `out`; the number of bytes, 0 when it does not fit.
template <class Payload>
size_t encode(Type type, uint8_t sequence, const Payload& payload, uint8_t* out, size_t capacity) {
  uint8_t message[kHeaderBytes + sizeof(Payload)];  // no field is longer on the wire than in memory
  Writer writer(message, sizeof message);
  Header header;
  header.type = type;
  header.sequence = sequence;
  header.fields(writer);
  Payload(payload).fields(writer);
  return writer.ok() ? encode_frame(message, writer.size(), out, capacity) : 0;
}

// Reads the header of a message; false when it is shorter than a header.
inline bool decode_header(const uint8_t* message, size_t size, Header& header) {
  if (size < kHeaderBytes) return false;
  Reader reader(message, kHeaderBytes);
  header.fields(reader);
  return true;
}

// Reads the payload behind the header; false when its length is wrong.
template <class Payload>
bool decode_payload(const uint8_t* message, size_t size, Payload& payload) {
  if (size < kHeaderBytes) return false;
  Reader reader(message + kHeaderBytes, size - kHeaderBytes);
  payload.fields(reader);
  return reader.whole();
}

}  // namespace protocol
}  // namespace beltpick
