#include "virtual_cell/gige/register_bank.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <utility>

#include "virtual_cell/gige/camera_xml.hpp"
#include "virtual_cell/gige/registers.hpp"

namespace beltpick::virtual_cell::gige {
namespace {

constexpr std::uint32_t kCapabilityBits = (1U << 0U)      // several registers in one command
                                          | (1U << 1U)    // write memory
                                          | (1U << 2U)    // packet resend
                                          | (1U << 5U)    // pending acknowledge
                                          | (1U << 30U);  // serial number register
constexpr std::uint32_t kDefaultHeartbeatMs = 3000;
constexpr std::uint32_t kDefaultPacketBytes = 1400;

bool writable(std::uint32_t at) {
  if (at < address::kHeartbeatTimeoutMs || at >= address::kBankSize) return false;
  return at != address::kStreamSourcePort && at != address::kSensorWidth && at != address::kSensorHeight &&
         at != address::kEdgesWhileExposing && at != address::kTickFrequencyLow;
}

}  // namespace

RegisterBank::RegisterBank(CameraIdentity identity, std::uint32_t ip) : identity_(std::move(identity)), ip_(ip) {
  const std::string xml = camera_xml();
  const std::size_t xml_bytes = (xml.size() + 4) / 4 * 4;
  bytes_.resize(address::kXml + xml_bytes);
  std::memcpy(bytes_.data() + address::kXml, xml.data(), xml.size());
  char url[64];
  std::snprintf(url, sizeof url, "Local:beltpick_camera.xml;%x;%zx", address::kXml, xml.size());
  set_text(address::kXmlUrl, url);
  set_bootstrap();
  set_features();
}

void RegisterBank::power_cycle() {
  {
    const std::scoped_lock lock(mutex_);
    std::fill(bytes_.begin() + address::kStreamPort, bytes_.begin() + address::kBankSize, std::uint8_t{0});
    put32(bytes_.data() + address::kControlPrivilege, 0);
  }
  set_bootstrap();
  set_features();
}

void RegisterBank::set_bootstrap() {
  set(address::kVersion, 0x00010002);     // GigE Vision 1.2
  set(address::kDeviceMode, 0x80000001);  // big-endian, UTF-8
  set(address::kMacLow, ip_);
  set(address::kCurrentIp, ip_);
  set(address::kSubnetMask, 0xff000000);
  set_text(address::kManufacturer, "Beltpick");
  set_text(address::kModel, "VirtualCamera");
  set_text(address::kDeviceVersion, "1");
  set_text(address::kSerial, identity_.serial.substr(0, 15));
  set(address::kNetworkInterfaces, 1);
  set(address::kStreamChannels, 1);
  set(address::kCapability, kCapabilityBits);
  set(address::kHeartbeatTimeoutMs, kDefaultHeartbeatMs);
  set(address::kTickFrequencyLow, 1'000'000);  // stamps count microseconds
  set(address::kStreamPacketSize, kDefaultPacketBytes);
}

void RegisterBank::set_features() {
  set(address::kSensorWidth, static_cast<std::uint32_t>(identity_.width));
  set(address::kSensorHeight, static_cast<std::uint32_t>(identity_.height));
  set(address::kWidth, static_cast<std::uint32_t>(identity_.width));
  set(address::kHeight, static_cast<std::uint32_t>(identity_.height));
  set(address::kPixelFormat, kMono8);
  set_double(address::kExposureTime, 8000.0);
}

GevStatus RegisterBank::read(std::uint32_t at, std::span<std::uint8_t> out) const {
  if (at % 4 != 0 || out.size() % 4 != 0) return GevStatus::kBadAlignment;
  if (at > bytes_.size() || out.size() > bytes_.size() - at) return GevStatus::kInvalidAddress;
  const std::scoped_lock lock(mutex_);
  std::memcpy(out.data(), bytes_.data() + at, out.size());
  return GevStatus::kSuccess;
}

GevStatus RegisterBank::write(std::uint32_t at, std::span<const std::uint8_t> bytes) {
  if (at % 4 != 0 || bytes.size() % 4 != 0) return GevStatus::kBadAlignment;
  if (at > bytes_.size() || bytes.size() > bytes_.size() - at) return GevStatus::kInvalidAddress;
  for (std::uint32_t offset = 0; offset < bytes.size(); offset += 4) {
    if (!writable(at + offset)) return GevStatus::kWriteProtect;
  }
  const std::scoped_lock lock(mutex_);
  std::memcpy(bytes_.data() + at, bytes.data(), bytes.size());
  return GevStatus::kSuccess;
}

std::uint32_t RegisterBank::get(std::uint32_t at) const {
  const std::scoped_lock lock(mutex_);
  return get32(bytes_.data() + at);
}

void RegisterBank::set(std::uint32_t at, std::uint32_t value) {
  const std::scoped_lock lock(mutex_);
  put32(bytes_.data() + at, value);
}

double RegisterBank::get_double(std::uint32_t at) const {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t high = get32(bytes_.data() + at);
  return std::bit_cast<double>((high << 32U) | get32(bytes_.data() + at + 4));
}

void RegisterBank::set_double(std::uint32_t at, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  set(at, static_cast<std::uint32_t>(bits >> 32U));
  set(at + 4, static_cast<std::uint32_t>(bits));
}

void RegisterBank::set_text(std::uint32_t at, const std::string& text) {
  const std::scoped_lock lock(mutex_);
  std::memcpy(bytes_.data() + at, text.data(), text.size());
}

}  // namespace beltpick::virtual_cell::gige
