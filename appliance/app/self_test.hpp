// The facts of a self-test, from the devices, files and limits that this appliance has.
#pragma once

#include "app/settings.hpp"
#include "app/wiring.hpp"
#include "base/arena.hpp"
#include "capture/camera.hpp"
#include "projector/projector_keeper.hpp"
#include "service/self_test_facts.hpp"

namespace beltpick::app {

class ModelHub;

// Whose facts they are. `plc_port` and `service_port` tell how these ports are served; a kNotUsed one is tried here.
struct SelfTestOf {
  const Settings& settings;
  const capture::Camera& camera;
  const Wiring& wiring;
  const projector::ProjectorKeeper& projector;
  const ModelHub& hub;
  bool memory_locked = false;
  std::int64_t memory_bytes = 0;
  service::PortFound plc_port, service_port;
};

// Of a running appliance: opens nothing, asks nobody.
service::SelfTestFacts gather_facts(const SelfTestOf& of);

// For an appliance that does not run: opens camera, trigger box, lines and projector and gives them some seconds;
// leaves them alone where a running beltpickd has them, and takes its word.
service::SelfTestFacts gather_facts_alone(SelfTestOf of, capture::Camera& camera, Wiring& wiring,
                                          projector::ProjectorKeeper& projector);

}  // namespace beltpick::app
