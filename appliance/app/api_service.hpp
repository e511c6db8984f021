// The HTTPS service of a running appliance, wired to its settings, its log and its watchdog.
#pragma once

#include <memory>

#include "app/log.hpp"
#include "app/settings.hpp"
#include "app/watchdog.hpp"
#include "service/service.hpp"

namespace beltpick::app {

// Before the watchdog is looked at. Null where it cannot be served: a cell that cannot be reached over the network
// works all the same, and what is in the way is logged.
std::unique_ptr<service::Service> start_api_service(const Settings& settings, service::Store& store,
                                                    service::CellSide& cell, Log& log, Watchdog& watchdog);

}  // namespace beltpick::app
