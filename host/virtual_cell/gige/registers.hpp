// Addresses in the camera's register space: the GigE Vision bootstrap registers, then the features of our own GenICam
// description (camera_xml.hpp). All registers are big-endian and of four bytes unless their comment says otherwise.
#pragma once

#include <cstdint>

namespace beltpick::virtual_cell::gige::address {

// Bootstrap registers as GigE Vision fixes them.
inline constexpr std::uint32_t kVersion = 0x0000;
inline constexpr std::uint32_t kDeviceMode = 0x0004;
inline constexpr std::uint32_t kMacLow = 0x000c;
inline constexpr std::uint32_t kCurrentIp = 0x0024;
inline constexpr std::uint32_t kSubnetMask = 0x0034;
inline constexpr std::uint32_t kManufacturer = 0x0048;   // 32 characters
inline constexpr std::uint32_t kModel = 0x0068;          // 32 characters
inline constexpr std::uint32_t kDeviceVersion = 0x0088;  // 32 characters
inline constexpr std::uint32_t kSerial = 0x00d8;         // 16 characters
inline constexpr std::uint32_t kDiscoverySize = 0x00f8;  // the registers below this make the discovery answer
inline constexpr std::uint32_t kXmlUrl = 0x0200;         // 512 characters
inline constexpr std::uint32_t kNetworkInterfaces = 0x0600;
inline constexpr std::uint32_t kMessageChannels = 0x0900;
inline constexpr std::uint32_t kStreamChannels = 0x0904;
inline constexpr std::uint32_t kCapability = 0x0934;
inline constexpr std::uint32_t kHeartbeatTimeoutMs = 0x0938;
inline constexpr std::uint32_t kTickFrequencyLow = 0x0940;
inline constexpr std::uint32_t kControlPrivilege = 0x0a00;
inline constexpr std::uint32_t kStreamPort = 0x0d00;
inline constexpr std::uint32_t kStreamPacketSize =
    0x0d04;  // low half: bytes of the IP packet; bit 31 fires a test packet
inline constexpr std::uint32_t kStreamPacketDelay = 0x0d08;
inline constexpr std::uint32_t kStreamAddress = 0x0d18;
inline constexpr std::uint32_t kStreamSourcePort = 0x0d1c;

// Features.
inline constexpr std::uint32_t kSensorWidth = 0xa000;
inline constexpr std::uint32_t kSensorHeight = 0xa004;
inline constexpr std::uint32_t kWidth = 0xa008;
inline constexpr std::uint32_t kHeight = 0xa00c;
inline constexpr std::uint32_t kOffsetX = 0xa010;
inline constexpr std::uint32_t kOffsetY = 0xa014;
inline constexpr std::uint32_t kPixelFormat = 0xa018;
inline constexpr std::uint32_t kAcquisitionMode = 0xa020;
inline constexpr std::uint32_t kAcquisitionStart = 0xa024;
inline constexpr std::uint32_t kAcquisitionStop = 0xa028;
inline constexpr std::uint32_t kTriggerSelector = 0xa030;
inline constexpr std::uint32_t kTriggerMode = 0xa034;
inline constexpr std::uint32_t kTriggerSource = 0xa038;
inline constexpr std::uint32_t kTriggerActivation = 0xa03c;
inline constexpr std::uint32_t kTriggerSoftware = 0xa040;
inline constexpr std::uint32_t kExposureMode = 0xa044;
inline constexpr std::uint32_t kExposureTime = 0xa048;  // eight bytes, double
inline constexpr std::uint32_t kEdgesWhileExposing = 0xa050;
inline constexpr std::uint32_t kGain = 0xa058;  // eight bytes, double
inline constexpr std::uint32_t kParametersLocked = 0xa060;
inline constexpr std::uint32_t kBankSize = 0xb000;
inline constexpr std::uint32_t kXml = 0x10000;  // the zero-terminated XML text, read only

}  // namespace beltpick::virtual_cell::gige::address

namespace beltpick::virtual_cell::gige {

inline constexpr std::uint32_t kMono8 = 0x01080001;
enum TriggerSourceValue : std::uint32_t { kSourceLine0 = 0, kSourceSoftware = 1 };
enum TriggerActivationValue : std::uint32_t { kRisingEdge = 0, kFallingEdge = 1 };
enum ExposureModeValue : std::uint32_t { kTimed = 0, kTriggerWidth = 1 };

}  // namespace beltpick::virtual_cell::gige
