#include "app/api_service.hpp"

#include "base/clock.hpp"

namespace beltpick::app {

namespace {

constexpr std::int64_t kHangs_ms =
    300'000;  // its threads have the lowest priority, and judging a template takes seconds

service::ServerConfig server_config(const Settings& settings) {
  service::ServerConfig config;
  config.address = settings.service_address;
  config.port = static_cast<std::uint16_t>(settings.service_port);
  config.connections = settings.service_connections;
  config.connections_per_address = settings.service_connections_per_address;
  config.requests_per_minute = settings.service_requests_per_minute;
  config.request_s = settings.service_request_s;
  config.idle_s = settings.service_idle_s;
  return config;
}

std::function<void()> beat_of(Watchdog& watchdog, const char* thread) {
  return [&beat = watchdog.add(thread, kHangs_ms, monotonic_us())] { beat(monotonic_us()); };
}

}  // namespace

std::unique_ptr<service::Service> start_api_service(const Settings& settings, service::Store& store,
                                                    service::CellSide& cell, Log& log, Watchdog& watchdog) {
  const auto write = [&log](bool warning, const std::string& line) {
    log.write(warning ? LogLevel::kWarning : LogLevel::kInfo, "%s", line.c_str());
  };
  auto started = service::Service::start(from_settings(settings, settings.state), server_config(settings), store, cell,
                                         write, {beat_of(watchdog, "https"), beat_of(watchdog, "https-slow")});
  if (started) return std::move(*started);
  log.write(LogLevel::kFault, "service: not served: %s", started.error().detail);
  return nullptr;
}

}  // namespace beltpick::app
