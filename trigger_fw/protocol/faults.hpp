// Why the firmware stops (Fault: latched until CLEAR) and why it says no (Refusal: nothing changed). Numbers are only
// ever added: firmware fault n is result code 200 + n of the appliance.
#pragma once

#include <stdint.h>

namespace beltpick {
namespace protocol {

enum class Fault : uint8_t {
  kNone = 0,
  kStrobeMissing = 1,
  kStrobeEarly = 2,
  kStrobeDouble = 3,
  kStrobeTooLong = 4,
  kStrobeTooShort = 5,
  kBeltMoved = 6,
  kEmergencyStop = 7,
  kHostSilent = 8,
  kEventsLost = 9,
  kTimerLate = 10,
  kBrownOut = 11,
  kWatchdogReset = 12,
  kFlashDamaged = 13,
};
constexpr uint8_t kFaultCount = 13;

enum class Refusal : uint8_t {
  kNone = 0,  // done, or done already
  kUnknownMessage = 1,
  kMalformed = 2,
  kWrongVersion = 3,
  kSequenceRunning = 4,
  kFaultLatched = 5,
  kNoFrames = 6,
  kTooManyGroups = 7,
  kTooManyFrames = 8,
  kExposureOutOfRange = 9,
  kSettleTooShort = 10,
  kPeriodTooShort = 11,
  kPeriodTooLong = 12,
  kArmIdUsed = 13,
  kNotArmed = 14,
  kBeltNotStopped = 15,
  kEmergencyStopPressed = 16,
  kStrobeActive = 17,
  kIntervalTooShort = 18,
  kFlashDamaged = 19,
};
constexpr uint8_t kRefusalCount = 19;

// For people; not compiled into the firmware unless it is used there.
struct FaultEntry {
  Fault fault;
  const char* name;
  const char* cause;
  const char* remedy;
};

constexpr FaultEntry kFaultTable[kFaultCount] = {
    {Fault::kStrobeMissing, "STROBE_MISSING", "the camera did not expose when it was triggered",
     "check the trigger and strobe lines, and that the camera is armed on its line input"},
    {Fault::kStrobeEarly, "STROBE_EARLY", "the camera exposed without being triggered",
     "check that the camera does not run freely, and the strobe line for noise"},
    {Fault::kStrobeDouble, "STROBE_DOUBLE", "the camera exposed twice for one trigger",
     "check the trigger line for bouncing and its termination"},
    {Fault::kStrobeTooLong, "STROBE_TOO_LONG", "the camera exposed longer than the trigger pulse",
     "set the camera to ExposureMode TriggerWidth, or its exposure time to that of the sequence"},
    {Fault::kStrobeTooShort, "STROBE_TOO_SHORT", "the camera exposed shorter than the trigger pulse",
     "set the camera to ExposureMode TriggerWidth, or its exposure time to that of the sequence"},
    {Fault::kBeltMoved, "BELT_MOVED", "the belt-stopped input fell during the sequence",
     "the PLC must hold the belt while 'capturing'; check the line"},
    {Fault::kEmergencyStop, "EMERGENCY_STOP", "the emergency-stop input is active", "release it, then clear the fault"},
    {Fault::kHostSilent, "HOST_SILENT", "the appliance fell silent during the sequence",
     "check the serial cable and that beltpickd runs"},
    {Fault::kEventsLost, "EVENTS_LOST", "the serial line was too slow for the events of the sequence",
     "check the serial cable and its speed"},
    {Fault::kTimerLate, "TIMER_LATE", "an edge came later than the timer asked", "a fault of the firmware: report it"},
    {Fault::kBrownOut, "BROWN_OUT", "the supply of the trigger box fell too low, and it started anew",
     "check its supply and its USB cable"},
    {Fault::kWatchdogReset, "WATCHDOG_RESET", "the firmware hung and was reset by its watchdog",
     "a fault of the firmware: report it"},
    {Fault::kFlashDamaged, "FLASH_DAMAGED", "the program in the flash is damaged", "flash the firmware anew"},
};

struct RefusalEntry {
  Refusal refusal;
  const char* text;
};

constexpr RefusalEntry kRefusalTable[kRefusalCount] = {
    {Refusal::kUnknownMessage, "message not known to this firmware"},
    {Refusal::kMalformed, "message has the wrong length"},
    {Refusal::kWrongVersion, "firmware speaks another version of the protocol: flash the matching firmware"},
    {Refusal::kSequenceRunning, "a sequence is running"},
    {Refusal::kFaultLatched, "a fault is latched: clear it first"},
    {Refusal::kNoFrames, "the sequence, or a group of it, has no frames"},
    {Refusal::kTooManyGroups, "more groups than the firmware holds"},
    {Refusal::kTooManyFrames, "more frames than the firmware allows"},
    {Refusal::kExposureOutOfRange, "exposure is outside the limits of the firmware"},
    {Refusal::kSettleTooShort, "settle time is shorter than the projector's advance pulse"},
    {Refusal::kPeriodTooShort,
     "period is shorter than exposure + readout (max(exposure + gap, readout) where the camera overlaps them), or than "
     "settle + exposure + strobe tolerance"},
    {Refusal::kPeriodTooLong, "period is longer than the firmware allows"},
    {Refusal::kArmIdUsed, "this arm id was used already, or for another sequence"},
    {Refusal::kNotArmed, "nothing is armed under this id"},
    {Refusal::kBeltNotStopped, "the belt-stopped input is not active"},
    {Refusal::kEmergencyStopPressed, "the emergency stop is pressed"},
    {Refusal::kStrobeActive, "the camera's strobe is active already"},
    {Refusal::kIntervalTooShort, "two edges of a pin are closer than the firmware's interrupts can follow"},
    {Refusal::kFlashDamaged, "the program in the flash is damaged: flash the firmware anew"},
};

// True for the faults of the firmware's own start: no sequence made them.
inline bool from_start(Fault fault) {
  return fault == Fault::kBrownOut || fault == Fault::kWatchdogReset || fault == Fault::kFlashDamaged;
}

// The entry of a fault or refusal; null for kNone and for numbers of a newer firmware.
inline const FaultEntry* find_fault(Fault fault) {
  const uint8_t number = static_cast<uint8_t>(fault);
  return number >= 1 && number <= kFaultCount ? &kFaultTable[number - 1] : nullptr;
}
inline const char* refusal_text(Refusal refusal) {
  const uint8_t number = static_cast<uint8_t>(refusal);
  return number >= 1 && number <= kRefusalCount ? kRefusalTable[number - 1].text : "reason not known to this version";
}

}  // namespace protocol
}  // namespace beltpick
