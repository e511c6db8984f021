// The checks of the self-test, a function each: facts in, verdict with cause and remedy out.
#pragma once

#include "service/self_test_facts.hpp"

namespace beltpick::service {

// self_test_devices.cpp
Check check_camera(const CameraFound& camera, const CalibrationFound& calibration);
Check check_image_size(const CameraFound& camera);
Check check_exposure(const CameraFound& camera);
Check check_packet_size(const CameraFound& camera);
Check check_socket_buffer(const SocketBufferFound& buffer);
Check check_trigger(const TriggerFound& trigger);
Check check_lines(const TriggerFound& trigger);
Check check_gpio(const GpioFound& gpio);
Check check_projector(const ProjectorFound& projector);

// self_test_machine.cpp
Check check_plc_port(const PortFound& port);
Check check_folder(const char* name, const FolderFound& folder, const char* without);
Check check_clock(const ClockFound& clock);
Check check_memory(const MemoryFound& memory);
Check check_realtime(bool allowed);
Check check_service(const PortFound& port, const CertificateFound& certificate);

// self_test_models.cpp
Check check_store(const StoreFound& store);
Check check_calibration(const CalibrationFound& calibration);
Check check_models(const ModelsFound& models);

// The parts that they are made of; the texts are printf's.
[[gnu::format(printf, 2, 3)]] Check good(const char* name, const char* found, ...);
[[gnu::format(printf, 2, 3)]] Check skipped(const char* name, const char* found, ...);
// `cause` and `remedy` in full; `found` is added by the caller.
Check not_good(Verdict verdict, const char* name, std::string found, std::string cause, std::string remedy);
// What a failed operation told, split at its remedy.
Check failed_by(const char* name, const Error& problem);
// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

}  // namespace beltpick::service
