// The commands of the DLPC350 that the driver uses, and the bits of its answers. The names in quotes are the headings
// and tables of Texas Instruments' "DLPC350 Programmer's Guide" (DLPU010), chapter 2; the number is the USB command,
// CMD2 before CMD3. Numbers of several bytes have the low byte first.
#pragma once

#include <array>
#include <cstdint>

namespace beltpick::projector {

struct Command {
  std::uint16_t number;
  const char* name;  // for messages
};

// "Status Commands".
inline constexpr Command kHardwareStatus{0x1A0A, "hardware status"};  // 1 byte: kHardwareFaults
inline constexpr Command kMainStatus{0x1A0C, "main status"};          // 1 byte: kMirrorsParked
// "Firmware Version": 16 bytes; the first four are the application's: patch (2 bytes), minor, major.
inline constexpr Command kVersion{0x0205, "firmware version"};
inline constexpr Command kImagesInFlash{0x1A42, "number of images in flash"};  // 1 byte

// "Display Mode Selection": 0 video, 1 pattern display.
inline constexpr Command kDisplayMode{0x1A1B, "display mode"};
// "Pattern Display Data Input Source": 0 video port, 3 flash.
inline constexpr Command kPatternSource{0x1A22, "pattern source"};
// "Pattern Trigger Mode Selection": 1 = each pattern by its own trigger, internal or TRIG_IN_1; TRIG_IN_2 starts and
// stops.
inline constexpr Command kTriggerMode{0x1A23, "trigger mode"};
// "Pattern Display Start/Stop": 0 stop, 1 pause, 2 start. A start after a stop begins with the first pattern.
inline constexpr Command kStartStop{0x1A24, "start and stop"};
// "Pattern Display Exposure and Frame Period": two times of 4 bytes in us.
inline constexpr Command kExposurePeriod{0x1A29, "exposure and period"};
// "Pattern Display LUT Control": number of patterns - 1; 1 = repeat; patterns for one TRIG_OUT_2 - 1; images - 1.
inline constexpr Command kTableControl{0x1A31, "pattern table control"};
// "Pattern Display LUT Offset Pointer": the entry from which the open table is written.
inline constexpr Command kTableOffset{0x1A32, "table offset"};
// "Pattern Display LUT Access Control": 0 none is open, 1 the image table, 2 the pattern table.
inline constexpr Command kTableAccess{0x1A33, "table access"};
// "Pattern Display LUT Data": 1 byte an image, or 3 bytes a pattern ("Pattern Definition"): see PatternEntry.
inline constexpr Command kTableData{0x1A34, "table data"};
// "Trigger In 1": delay from the edge to the pattern in units of 107.2 ns, 4 bytes.
inline constexpr Command kTriggerIn1{0x1A35, "trigger input delay"};
// "Pattern Display LUT Validation": a write starts it, a read gives kValidationFaults.
inline constexpr Command kValidate{0x1A1A, "validation"};

enum class TableOpen : std::uint8_t { kNone = 0, kImages = 1, kPatterns = 2 };
inline constexpr std::uint8_t kStop = 0, kStart = 2;
inline constexpr std::uint8_t kPatternDisplay = 1;
inline constexpr std::uint8_t kFromFlash = 3;
inline constexpr std::uint8_t kTriggeredPatterns = 1;
inline constexpr double kTriggerDelayUnit_us = 0.1072;

// "Pattern Definition", byte 0 bits 1:0.
enum class PatternTrigger : std::uint8_t { kInternal = 0, kRisingEdge = 1, kFallingEdge = 2, kContinue = 3 };

// Bits of the light sources, byte 1 bits 6:4.
inline constexpr std::uint8_t kLedRed = 1, kLedGreen = 2, kLedBlue = 4;

// One entry of the pattern table.
struct PatternEntry {
  PatternTrigger trigger = PatternTrigger::kRisingEdge;
  std::uint8_t number = 0;  // among the patterns of this depth in the image: "Pattern Number Mapping"
  std::uint8_t depth = 1;
  std::uint8_t leds = 0;
  bool invert = false;
  bool black_after = false;  // "insert black-fill pattern after current pattern"
  bool swap_buffer = false;  // "perform a buffer swap": this pattern is the first of the next image
  bool keep_trigger_out = false;
};

constexpr std::array<std::uint8_t, 3> bytes_of(const PatternEntry& entry) {
  return {static_cast<std::uint8_t>(entry.number << 2U | static_cast<std::uint8_t>(entry.trigger)),
          static_cast<std::uint8_t>(entry.leds << 4U | entry.depth),
          static_cast<std::uint8_t>((entry.invert ? 1U : 0U) | (entry.black_after ? 2U : 0U) |
                                    (entry.swap_buffer ? 4U : 0U) | (entry.keep_trigger_out ? 8U : 0U))};
}

constexpr std::array<std::uint8_t, 4> bytes_of(std::uint32_t number) {
  return {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8U),
          static_cast<std::uint8_t>(number >> 16U), static_cast<std::uint8_t>(number >> 24U)};
}

// A bit of an answer that means something is wrong, in the order in which they are told.
struct FaultBit {
  std::uint8_t mask;
  bool bad_when;  // its value
  const char* text;
};

inline constexpr std::array<FaultBit, 5> kHardwareFaults{{
    {0x01, false, "internal initialisation failed"},
    {0x04, true, "DMD reset controller error"},
    {0x08, true, "forced buffer swap: an image was not loaded in time"},
    {0x40, true, "sequencer aborted"},
    {0x80, true, "sequencer error"},
}};

inline constexpr std::uint8_t kMirrorsParked = 0x01;  // of the main status

inline constexpr std::uint8_t kValidating = 0x80;
inline constexpr std::array<FaultBit, 5> kValidationFaults{{
    {0x01, true, "exposure or frame period out of range"},
    {0x02, true, "pattern number out of range"},
    {0x04, true, "trigger output 1 without a gap, or black fills overlap"},
    {0x08, true, "no black fill before an externally triggered pattern"},
    {0x10, true, "frame period less than 230 us longer than the exposure"},
}};

}  // namespace beltpick::projector
