#include "virtual_cell/gige/camera_xml.hpp"

#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <utility>

#include "virtual_cell/gige/registers.hpp"

namespace beltpick::virtual_cell::gige {
namespace {

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%x", value);
  return text;
}

std::string tag(const std::string& name, const std::string& value) {
  return "<" + name + ">" + value + "</" + name + ">";
}

std::string register_node(const std::string& kind, const std::string& name, std::uint32_t at, int length,
                          const std::string& access) {
  std::string text = "<" + kind + " Name=\"" + name + "\">" + tag("Address", hex(at)) +
                     tag("Length", std::to_string(length)) + tag("AccessMode", access) + tag("pPort", "Device");
  if (kind != "StringReg") text += tag("Cachable", "NoCache");
  if (kind == "IntReg") text += tag("Sign", "Unsigned");
  if (kind == "IntReg" || kind == "FloatReg") text += tag("Endianess", "BigEndian");
  return text + "</" + kind + ">\n";
}

std::string integer(const std::string& name, std::uint32_t at, const std::string& access, const std::string& limits) {
  return "<Integer Name=\"" + name + "\">" + tag("pValue", name + "Register") + limits + "</Integer>\n" +
         register_node("IntReg", name + "Register", at, 4, access);
}

std::string decimal(const std::string& name, std::uint32_t at, double low, double high, const std::string& unit) {
  return "<Float Name=\"" + name + "\">" + tag("pValue", name + "Register") + tag("Min", std::to_string(low)) +
         tag("Max", std::to_string(high)) + tag("Unit", unit) + "</Float>\n" +
         register_node("FloatReg", name + "Register", at, 8, "RW");
}

std::string enumeration(const std::string& name, std::uint32_t at,
                        std::initializer_list<std::pair<const char*, std::uint32_t>> entries) {
  std::string text = "<Enumeration Name=\"" + name + "\">";
  for (const auto& [entry, value] : entries) {
    text += "<EnumEntry Name=\"" + std::string(entry) + "\">" + tag("Value", std::to_string(value)) + "</EnumEntry>";
  }
  return text + tag("pValue", name + "Register") + "</Enumeration>\n" +
         register_node("IntReg", name + "Register", at, 4, "RW");
}

std::string command(const std::string& name, std::uint32_t at) {
  return "<Command Name=\"" + name + "\">" + tag("pValue", name + "Register") + tag("CommandValue", "1") +
         "</Command>\n" + register_node("IntReg", name + "Register", at, 4, "RW");
}

std::string category(const std::string& name, std::initializer_list<const char*> features) {
  std::string text = "<Category Name=\"" + name + "\">";
  for (const char* feature : features) text += tag("pFeature", feature);
  return text + "</Category>\n";
}

std::string categories() {
  return category("Root", {"DeviceControl", "ImageFormatControl", "AcquisitionControl", "AnalogControl",
                           "TransportLayerControl"}) +
         category("DeviceControl", {"DeviceVendorName", "DeviceModelName", "DeviceVersion", "DeviceSerialNumber"}) +
         category("ImageFormatControl",
                  {"SensorWidth", "SensorHeight", "Width", "Height", "OffsetX", "OffsetY", "PixelFormat"}) +
         category("AcquisitionControl", {"AcquisitionMode", "AcquisitionStart", "AcquisitionStop", "TriggerSelector",
                                         "TriggerMode", "TriggerSource", "TriggerActivation", "TriggerSoftware",
                                         "ExposureMode", "ExposureTime", "EdgesWhileExposing"}) +
         category("AnalogControl", {"Gain"}) +
         category("TransportLayerControl", {"PayloadSize", "GevSCPSPacketSize", "TLParamsLocked"});
}

std::string device_and_format() {
  const auto limits = [](const std::string& low, const std::string& high) { return tag("Min", low) + high; };
  return register_node("StringReg", "DeviceVendorName", address::kManufacturer, 32, "RO") +
         register_node("StringReg", "DeviceModelName", address::kModel, 32, "RO") +
         register_node("StringReg", "DeviceVersion", address::kDeviceVersion, 32, "RO") +
         register_node("StringReg", "DeviceSerialNumber", address::kSerial, 16, "RO") +
         integer("SensorWidth", address::kSensorWidth, "RO", "") +
         integer("SensorHeight", address::kSensorHeight, "RO", "") +
         integer("Width", address::kWidth, "RW", limits("16", tag("pMax", "SensorWidth") + tag("Inc", "1"))) +
         integer("Height", address::kHeight, "RW", limits("16", tag("pMax", "SensorHeight") + tag("Inc", "1"))) +
         integer("OffsetX", address::kOffsetX, "RW", limits("0", tag("pMax", "SensorWidth"))) +
         integer("OffsetY", address::kOffsetY, "RW", limits("0", tag("pMax", "SensorHeight"))) +
         enumeration("PixelFormat", address::kPixelFormat, {{"Mono8", kMono8}});
}

std::string acquisition() {
  return enumeration("AcquisitionMode", address::kAcquisitionMode, {{"Continuous", 0}}) +
         command("AcquisitionStart", address::kAcquisitionStart) +
         command("AcquisitionStop", address::kAcquisitionStop) +
         enumeration("TriggerSelector", address::kTriggerSelector, {{"FrameStart", 0}}) +
         enumeration("TriggerMode", address::kTriggerMode, {{"Off", 0}, {"On", 1}}) +
         enumeration("TriggerSource", address::kTriggerSource,
                     {{"Line0", kSourceLine0}, {"Software", kSourceSoftware}}) +
         enumeration("TriggerActivation", address::kTriggerActivation,
                     {{"RisingEdge", kRisingEdge}, {"FallingEdge", kFallingEdge}}) +
         command("TriggerSoftware", address::kTriggerSoftware) +
         enumeration("ExposureMode", address::kExposureMode, {{"Timed", kTimed}, {"TriggerWidth", kTriggerWidth}}) +
         decimal("ExposureTime", address::kExposureTime, 10.0, 1e6, "us") +
         integer("EdgesWhileExposing", address::kEdgesWhileExposing, "RO", "") +
         decimal("Gain", address::kGain, 0.0, 24.0, "dB");
}

std::string transport() {
  return "<IntSwissKnife Name=\"PayloadSize\"><pVariable Name=\"W\">Width</pVariable>"
         "<pVariable Name=\"H\">Height</pVariable><Formula>W*H</Formula></IntSwissKnife>\n"
         "<Integer Name=\"GevSCPSPacketSize\">" +
         tag("pValue", "GevSCPSPacketSizeRegister") + tag("Min", "576") + tag("Max", "16000") + tag("Inc", "4") +
         "</Integer>\n<MaskedIntReg Name=\"GevSCPSPacketSizeRegister\">" +
         tag("Address", hex(address::kStreamPacketSize)) + tag("Length", "4") + tag("AccessMode", "RW") +
         tag("pPort", "Device") + tag("Cachable", "NoCache") + tag("LSB", "31") + tag("MSB", "16") +
         tag("Sign", "Unsigned") + tag("Endianess", "BigEndian") + "</MaskedIntReg>\n" +
         integer("TLParamsLocked", address::kParametersLocked, "RW", tag("Min", "0") + tag("Max", "1"));
}

}  // namespace

std::string camera_xml() {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
         "<RegisterDescription ModelName=\"VirtualCamera\" VendorName=\"Beltpick\" ToolTip=\"beltpick virtual cell\""
         " StandardNameSpace=\"GEV\" SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" SchemaSubMinorVersion=\"0\""
         " MajorVersion=\"1\" MinorVersion=\"0\" SubMinorVersion=\"0\""
         " ProductGuid=\"6f2a4d0e-3a57-4b6c-9a51-6d5c0b1e7701\" VersionGuid=\"6f2a4d0e-3a57-4b6c-9a51-6d5c0b1e7702\""
         " xmlns=\"http://www.genicam.org/GenApi/Version_1_0\">\n" +
         categories() + device_and_format() + acquisition() + transport() +
         "<Port Name=\"Device\"/>\n</RegisterDescription>\n";
}

}  // namespace beltpick::virtual_cell::gige
