// Every result code of beltpick: number, name, what it means, what to do. Numbers are a promise to PLC programs: codes
// are only ever added. Codes 200 + n are the trigger firmware's fault n.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/result.hpp"
#include "protocol/faults.hpp"

namespace beltpick {

enum class ResultCode : std::uint16_t {
  kOk = 0,
  // Files and the command line.
  kUsage = 10,
  kFileNotFound = 11,
  kFileUnreadable = 12,
  kFileNotWritten = 13,
  kFormatInvalid = 14,
  kMemberMissing = 15,
  kValueOutOfRange = 16,
  kVersionUnsupported = 17,
  kChecksumWrong = 18,
  kFrameSizeMismatch = 19,
  kSequenceUndecodable = 20,
  kSequenceOrderWrong = 21,
  kCalibrationMismatch = 22,
  kMeshInvalid = 23,
  kLimitExceeded = 24,
  kTemplateTooLarge = 25,
  kTooFewPoints = 26,
  kNothingFound = 27,
  kServiceUnreachable = 28,
  // The appliance's service, and whoever asks it.
  kNotAuthorized = 29,
  kRoleTooLow = 30,
  kTooManyRequests = 31,
  kCertificateChanged = 32,
  kNotEnrolled = 33,
  kRequestMalformed = 34,
  kRouteUnknown = 35,
  kMethodNotAllowed = 36,
  kLengthRequired = 37,
  kBodyTooLarge = 38,
  kMediaTypeWrong = 39,
  kVersionChanged = 40,
  kServiceBusy = 41,
  kCheckFailed = 42,
  kItemInUse = 43,
  // A field update of the trigger box.
  kFirmwareUnfit = 44,
  kUpdateFailed = 45,
  kDeviceInUse = 46,
  // The running cell.
  kFrameMissing = 100,
  kFrameIncomplete = 101,
  kFrameWrongSize = 102,
  kFrameBlack = 103,
  kFrameDuplicated = 104,
  kCameraLost = 105,
  kCameraNotFound = 106,
  kTriggerLost = 107,
  kBeltMovedDuringCapture = 108,
  kBeltMovedDuringOffer = 109,
  kRobotInView = 110,
  kPickFailed = 111,
  kPlcSilent = 112,
  kEmergencyStop = 113,
  kOfferExpired = 114,
  kSignalsDisagree = 115,
  kCommandNotAllowed = 116,
  kCommandUnknown = 117,
  kRecipeUnknown = 118,
  kNoCalibration = 119,
  kNoTemplate = 120,
  kRestarted = 121,
  kModelChanged = 122,
  kCaptureTimeout = 123,
  kInternal = 124,
  kProcessingTimeout = 125,
  kCameraInUse = 126,
  kProjectorLost = 127,
  kProjectorSilent = 128,
  kProjectorRefused = 129,
  kProjectorWrongReply = 130,
  kProjectorFault = 131,
  kCameraNotTriggered = 132,
  kTriggerLineStuck = 133,
  kPatternRepeated = 134,
  kTriggerLineNoisy = 135,
  kLineNotFound = 136,
  kLineInUse = 137,
  kLinesLost = 138,
  kFrameExtra = 139,
  kFocusOff = 140,
  kLightFlickers = 141,
  kExposureBeats = 142,
  // Why an object was withheld.
  kObjectTooSmall = 150,
  kNoHypothesis = 151,
  kNotConverged = 152,
  kResidualTooHigh = 153,
  kCoverageTooLow = 154,
  kFreeSpaceViolated = 155,
  kPoseAmbiguous = 156,
  kObstructed = 157,
  kNoGrasp = 158,
  kPartlyOutOfView = 159,
  kSegmentLimit = 160,
  kDuplicatePose = 161,
  // 200 + n: the trigger firmware's fault n (trigger_fw/protocol).
  kFirmwareFaultBase = 200,
};

struct ResultCodeEntry {
  ResultCode code;
  std::string_view name;    // as it stands in result.json, logs and the register reference
  std::string_view cause;   // for the operator
  std::string_view remedy;  // what to do
};

inline constexpr auto kResultCodes = std::to_array<ResultCodeEntry>({
    {ResultCode::kOk, "OK", "done", ""},
    {ResultCode::kUsage, "USAGE", "the command line is wrong", "see --help"},
    {ResultCode::kFileNotFound, "FILE_NOT_FOUND", "a file or folder is not there", "check the path"},
    {ResultCode::kFileUnreadable, "FILE_UNREADABLE", "a file cannot be read",
     "check permissions and whether it is whole"},
    {ResultCode::kFileNotWritten, "FILE_NOT_WRITTEN", "a file cannot be written",
     "check the folder, permissions and free space"},
    {ResultCode::kFormatInvalid, "FORMAT_INVALID", "a file is not in the expected format",
     "correct it where the message points"},
    {ResultCode::kMemberMissing, "MEMBER_MISSING", "a file lacks a required member",
     "add the member that the message names"},
    {ResultCode::kValueOutOfRange, "VALUE_OUT_OF_RANGE", "a value is outside what is allowed",
     "correct the value that the message names"},
    {ResultCode::kVersionUnsupported, "VERSION_UNSUPPORTED", "the file's version is not known here",
     "update beltpick or write the file anew"},
    {ResultCode::kChecksumWrong, "CHECKSUM_WRONG", "the file was damaged", "copy or make it again"},
    {ResultCode::kFrameSizeMismatch, "FRAME_SIZE_MISMATCH", "frames of one capture differ in size", "capture again"},
    {ResultCode::kSequenceUndecodable, "SEQUENCE_UNDECODABLE",
     "the pattern sequence does not determine the projector coordinate", "add the frames that the message names"},
    {ResultCode::kSequenceOrderWrong, "SEQUENCE_ORDER_WRONG", "the images do not fit the declared order of frames",
     "check the frame list against the images"},
    {ResultCode::kCalibrationMismatch, "CALIBRATION_MISMATCH",
     "the calibration is of another camera, projector, size or region",
     "use the calibration of this cell, or calibrate"},
    {ResultCode::kMeshInvalid, "MESH_INVALID", "the mesh cannot be used", "export it again"},
    {ResultCode::kLimitExceeded, "LIMIT_EXCEEDED", "a declared limit is exceeded",
     "raise the limit in the configuration or reduce the input"},
    {ResultCode::kTemplateTooLarge, "TEMPLATE_TOO_LARGE", "a template is larger than the declared limits",
     "teach with fewer points or raise the limit"},
    {ResultCode::kTooFewPoints, "TOO_FEW_POINTS", "too few points were measured",
     "check exposure, focus and calibration"},
    {ResultCode::kNothingFound, "NOTHING_FOUND", "nothing was found", "check the view and the templates"},
    {ResultCode::kServiceUnreachable, "SERVICE_UNREACHABLE", "the appliance does not answer",
     "check address, port and that beltpickd runs"},
    {ResultCode::kNotAuthorized, "NOT_AUTHORIZED", "the token is missing, wrong or revoked",
     "enrol anew, or ask a commissioner for a token"},
    {ResultCode::kRoleTooLow, "ROLE_TOO_LOW", "the token's role may not do this",
     "use a token of the role that the message names"},
    {ResultCode::kTooManyRequests, "TOO_MANY_REQUESTS", "too many requests, or too many wrong tokens from one address",
     "wait as long as the message says"},
    {ResultCode::kCertificateChanged, "CERTIFICATE_CHANGED",
     "the appliance shows another certificate than at enrolment", "check that it is the appliance; then enrol anew"},
    {ResultCode::kNotEnrolled, "NOT_ENROLLED", "this user has no token for the appliance", "run beltpick enrol"},
    {ResultCode::kRequestMalformed, "REQUEST_MALFORMED", "the request does not follow HTTP or this API",
     "see /api/v1/openapi.json"},
    {ResultCode::kRouteUnknown, "ROUTE_UNKNOWN", "the API has no such path", "see /api/v1/openapi.json"},
    {ResultCode::kMethodNotAllowed, "METHOD_NOT_ALLOWED", "the path is there, but not for this method",
     "use a method that the answer's Allow header names"},
    {ResultCode::kLengthRequired, "LENGTH_REQUIRED", "the body's length is not told before it comes",
     "send Content-Length instead of Transfer-Encoding"},
    {ResultCode::kBodyTooLarge, "BODY_TOO_LARGE", "the body is larger than the API takes", "is it the right file?"},
    {ResultCode::kMediaTypeWrong, "MEDIA_TYPE_WRONG", "the body's Content-Type is not taken here",
     "send application/json, for a template application/octet-stream"},
    {ResultCode::kVersionChanged, "VERSION_CHANGED", "the item is no longer the one that If-Match names",
     "download it again and repeat the change on it"},
    {ResultCode::kServiceBusy, "SERVICE_BUSY", "the service has its hands full: another upload, a self-test",
     "try again in some seconds"},
    {ResultCode::kCheckFailed, "CHECK_FAILED", "a check of the cell failed", "do what the check's remedy says"},
    {ResultCode::kItemInUse, "ITEM_IN_USE", "the cell cannot do without this template or recipe",
     "select another recipe first, or upload one that does without it"},
    {ResultCode::kFirmwareUnfit, "FIRMWARE_UNFIT", "a firmware is for another board, or none of beltpick's",
     "give the board's firmware, or a board its boot loader; see 'beltpick flash --help'"},
    {ResultCode::kUpdateFailed, "UPDATE_FAILED", "the new firmware did not get into the microcontroller whole",
     "run 'beltpick flash' again: the boot loader waits for it"},
    {ResultCode::kDeviceInUse, "DEVICE_IN_USE", "another program has the device open",
     "end that program, or stop its service meanwhile"},
    {ResultCode::kFrameMissing, "FRAME_MISSING", "the camera delivered fewer frames than were triggered",
     "check trigger wiring, network and exposure + readout against the period"},
    {ResultCode::kFrameIncomplete, "FRAME_INCOMPLETE", "packets of a frame were lost",
     "check the network card, packet size and receive buffers"},
    {ResultCode::kFrameWrongSize, "FRAME_WRONG_SIZE", "a frame has another size than configured",
     "check the camera's region of interest"},
    {ResultCode::kFrameBlack, "FRAME_BLACK", "a frame is black",
     "check the projector, its advance line and the lens cap"},
    {ResultCode::kFrameDuplicated, "FRAME_DUPLICATED", "the same frame came twice",
     "check camera and network; of a stored capture, its files"},
    {ResultCode::kCameraLost, "CAMERA_LOST", "the camera no longer answers",
     "check its cable and power; it is reopened by itself"},
    {ResultCode::kCameraNotFound, "CAMERA_NOT_FOUND", "the configured camera does not answer",
     "check address or serial number, cable and power"},
    {ResultCode::kTriggerLost, "TRIGGER_LOST", "the trigger microcontroller no longer answers",
     "check its cable and power"},
    {ResultCode::kBeltMovedDuringCapture, "BELT_MOVED_DURING_CAPTURE", "the belt moved during the capture",
     "check the PLC's stop signal and the belt's brake"},
    {ResultCode::kBeltMovedDuringOffer, "BELT_MOVED_DURING_OFFER",
     "the belt moved while a pose was offered; it was revoked", "the PLC must wait for 'belt may move'"},
    {ResultCode::kRobotInView, "ROBOT_IN_VIEW", "the robot entered the view during the capture",
     "the PLC must keep the robot clear while 'capturing'"},
    {ResultCode::kPickFailed, "PICK_FAILED", "the robot reported a failed pick; the view is captured again",
     "check gripper and grasp"},
    {ResultCode::kPlcSilent, "PLC_SILENT", "the PLC's heartbeat stopped", "check the PLC and the network"},
    {ResultCode::kEmergencyStop, "EMERGENCY_STOP", "the emergency stop is pressed", "release it and clear the fault"},
    {ResultCode::kOfferExpired, "OFFER_EXPIRED", "the offer is older than max_age_ms; it was revoked",
     "check why the robot did not come"},
    {ResultCode::kSignalsDisagree, "SIGNALS_DISAGREE", "the belt-stopped line and register disagree",
     "check the wiring of the belt-stopped line"},
    {ResultCode::kCommandNotAllowed, "COMMAND_NOT_ALLOWED", "the command does not fit the present state",
     "see the state in the register table"},
    {ResultCode::kCommandUnknown, "COMMAND_UNKNOWN", "there is no such command", "see the register table"},
    {ResultCode::kRecipeUnknown, "RECIPE_UNKNOWN", "there is no recipe of that number",
     "upload it, or correct the number"},
    {ResultCode::kNoCalibration, "NO_CALIBRATION", "no calibration is loaded", "calibrate and upload it"},
    {ResultCode::kNoTemplate, "NO_TEMPLATE", "no template is loaded", "teach a part and upload it"},
    {ResultCode::kRestarted, "RESTARTED", "the appliance was restarted; offers before it are void",
     "clear it and start a new cycle"},
    {ResultCode::kModelChanged, "MODEL_CHANGED", "recipe, template or calibration changed; offers before it are void",
     "none; a running cycle captures again, after a switch of recipe start a new one"},
    {ResultCode::kCaptureTimeout, "CAPTURE_TIMEOUT", "the capture did not end in time", "check trigger and camera"},
    {ResultCode::kInternal, "INTERNAL", "a fault in beltpick itself", "send the log to the maintainer"},
    {ResultCode::kProcessingTimeout, "PROCESSING_TIMEOUT", "locating the parts took longer than processing_timeout_ms",
     "fewer parts or templates at once, or raise the time"},
    {ResultCode::kCameraInUse, "CAMERA_IN_USE", "another program controls the camera",
     "end the other program (a viewer, a second beltpickd); it is taken once it is free"},
    {ResultCode::kProjectorLost, "PROJECTOR_LOST", "the projector is not there",
     "check its cable and power, and that beltpickd may open it; it is looked for again by itself"},
    {ResultCode::kProjectorSilent, "PROJECTOR_SILENT", "the projector is there but does not answer",
     "switch it off and on; check its USB cable or its display connector"},
    {ResultCode::kProjectorRefused, "PROJECTOR_REFUSED", "the projector refused a command or the sequence",
     "do what the message says; check the images in its flash against the plan"},
    {ResultCode::kProjectorWrongReply, "PROJECTOR_WRONG_REPLY", "the projector answered something else than was asked",
     "end other programs that talk to it; switch it off and on; check its model and firmware"},
    {ResultCode::kProjectorFault, "PROJECTOR_FAULT", "the projector reports a fault of its own, or stopped showing",
     "switch it off and on; check its lamp, temperature and advance line"},
    {ResultCode::kCameraNotTriggered, "CAMERA_NOT_TRIGGERED",
     "the camera neither exposed nor sent a frame when it was triggered",
     "check the trigger line to the camera, and that the camera is armed on its line input"},
    {ResultCode::kTriggerLineStuck, "TRIGGER_LINE_STUCK",
     "the camera went on exposing when the trigger's pulse had ended, and sent no frame",
     "check the trigger line to the camera for a short to its supply"},
    {ResultCode::kPatternRepeated, "PATTERN_REPEATED", "the projector showed the same pattern twice",
     "check the projector's advance line"},
    {ResultCode::kTriggerLineNoisy, "TRIGGER_LINE_NOISY",
     "what comes from the trigger microcontroller is damaged on the way",
     "check its cable, shield and ground, and keep it away from drives"},
    {ResultCode::kLineNotFound, "LINE_NOT_FOUND", "a digital line or its GPIO chip is not there or may not be used",
     "correct [lines] in the configuration; gpioinfo lists the lines of this PC"},
    {ResultCode::kLineInUse, "LINE_IN_USE", "another program holds a digital line",
     "end that program, or name another line in [lines]"},
    {ResultCode::kLinesLost, "LINES_LOST", "the digital lines of this PC cannot be read or written any more",
     "check the GPIO chip, its driver and its cable; then restart beltpickd"},
    {ResultCode::kFrameExtra, "FRAME_EXTRA", "the camera sent an image that no pulse asked for",
     "check the trigger line for noise, and that nothing else triggers the camera"},
    {ResultCode::kFocusOff, "FOCUS_OFF", "fine stripes cannot be seen where coarse ones can",
     "focus projector and camera on the objects"},
    {ResultCode::kLightFlickers, "LIGHT_FLICKERS", "lamps flicker from frame to frame",
     "expose for a multiple of 10 ms (50 Hz) or 8.333 ms (60 Hz), or shade the cell"},
    {ResultCode::kExposureBeats, "EXPOSURE_BEATS", "the projector's light differs from frame to frame",
     "expose for a whole number of the projector's frames"},
    {ResultCode::kObjectTooSmall, "OBJECT_TOO_SMALL", "the object has too few points to judge",
     "dirt, or a part mostly hidden"},
    {ResultCode::kNoHypothesis, "NO_HYPOTHESIS", "no template fits the object even roughly",
     "a foreign object, or a part not taught"},
    {ResultCode::kNotConverged, "NOT_CONVERGED", "no hypothesis converged",
     "a foreign object, or a part mostly hidden"},
    {ResultCode::kResidualTooHigh, "RESIDUAL_TOO_HIGH", "the best pose leaves too large a distance to the surface",
     "a foreign or damaged part, or a wrong template"},
    {ResultCode::kCoverageTooLow, "COVERAGE_TOO_LOW", "too little of what should be visible was measured",
     "a part mostly hidden, shiny, or a foreign object"},
    {ResultCode::kFreeSpaceViolated, "FREE_SPACE_VIOLATED", "the pose claims space that was seen to be empty",
     "a foreign object, or a wrong template"},
    {ResultCode::kPoseAmbiguous, "POSE_AMBIGUOUS", "two different poses fit equally well",
     "wait for a better view of the part"},
    {ResultCode::kObstructed, "OBSTRUCTED", "another object lies over the part or in the gripper's way",
     "it comes free when the other is picked"},
    {ResultCode::kNoGrasp, "NO_GRASP", "no taught grasp can be reached", "teach further grasps"},
    {ResultCode::kPartlyOutOfView, "PARTLY_OUT_OF_VIEW", "too much of the part is outside the image",
     "it is seen whole on its next lap"},
    {ResultCode::kSegmentLimit, "SEGMENT_LIMIT", "more objects than the declared limit",
     "raise the limit or put fewer parts on the belt"},
    {ResultCode::kDuplicatePose, "DUPLICATE_POSE", "the pose overlaps one that is better supported", ""},
});

// The trigger firmware's fault n as result code 200 + n.
constexpr ResultCode firmware_code(protocol::Fault fault) {
  return static_cast<ResultCode>(static_cast<int>(ResultCode::kFirmwareFaultBase) + static_cast<int>(fault));
}

// All of them, from the firmware's own table.
inline constexpr auto kFirmwareResultCodes = [] {
  std::array<ResultCodeEntry, protocol::kFaultCount> entries{};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const protocol::FaultEntry& fault = protocol::kFaultTable[i];
    entries[i] = {firmware_code(fault.fault), fault.name, fault.cause, fault.remedy};
  }
  return entries;
}();

// The entry of a code; unknown numbers answer with null.
constexpr const ResultCodeEntry* find_result_code(ResultCode code) {
  for (const ResultCodeEntry& entry : kResultCodes) {
    if (entry.code == code) return &entry;
  }
  for (const ResultCodeEntry& entry : kFirmwareResultCodes) {
    if (entry.code == code) return &entry;
  }
  return nullptr;
}

constexpr std::string_view result_code_name(ResultCode code) {
  const ResultCodeEntry* entry = find_result_code(code);
  if (entry != nullptr) return entry->name;
  return code > ResultCode::kFirmwareFaultBase ? "FIRMWARE_FAULT" : "UNKNOWN";
}

}  // namespace beltpick
