#include "app/appliance.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>

#include "app/api_service.hpp"
#include "base/clock.hpp"
#include "base/thread_priority.hpp"

namespace beltpick::app {

namespace {

constexpr int kCycleStep_ms = 2;
constexpr int kPlcStep_ms = 10;
constexpr int kServiceStep_ms = 20;
constexpr int kModelsNice = 10;  // reading and building what is to come must not take time from the cycle
constexpr int kSupervise_ms = 50;
constexpr int kStop_ms = 1200;  // what the vision thread has to end in; the whole stop takes less than 2 s
constexpr int kStopApi_ms = 300;
constexpr int kThreadLimit_ms = 2000;
constexpr int kExitHung = 3;

cycle::CycleConfig cycle_config(const Settings& settings) {
  cycle::CycleConfig config;
  config.rest = {settings.settle_ms * 1000LL, settings.signals_agree_ms * 1000LL};
  config.processing_timeout_us = settings.processing_timeout_ms * 1000LL;
  config.max_age_us = settings.max_age_ms * 1000LL;
  config.max_failed_picks = settings.max_failed_picks;
  // From the clock: an answer to an offer of before a restart will hardly fit one of after it.
  config.first_offer_sequence = static_cast<std::uint16_t>(1 + std::time(nullptr) % 0xFFFF);
  return config;
}

capture::CameraConfig camera_config(const Settings& settings) {
  capture::CameraConfig config;
  config.id = settings.camera_id;
  config.width = settings.limits.image_width;
  config.height = settings.limits.image_height;
  config.buffers = settings.camera_buffers;
  config.packet_socket = settings.packet_socket;
  return config;
}

// The vision thread beats between its jobs: a capture of frames a second apart at the slowest, or locating.
std::int64_t longest_job_ms(const Settings& settings) {
  return std::max<std::int64_t>(settings.processing_timeout_ms, settings.limits.frames * 1000LL) + 10'000;
}

void name_thread(std::thread& thread, const char* name) { pthread_setname_np(thread.native_handle(), name); }

sigset_t handled_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, number);
  return signals;
}

}  // namespace

Stages::Stages(Arena& arena, const Settings& settings, Log& log, RunBook& book)
    : hub(arena, settings, log),
      camera(camera_config(settings), arena),
      wiring(settings),
      projector(make_projector(settings)),
      pages(projector),
      stepped(wiring.trigger(), pages, settings.projector_latency_us),
      recorder(arena, settings, log),
      work(arena, settings,
           {camera, projector.leads() ? stepped : wiring.trigger(), hub, recorder, projector, book, refused, log}) {
  hub.on_load([this](const Geometry& geometry, LoadedRecipe& recipe) { return work.adopt(geometry, recipe); });
}

// The threads of a running appliance; made in run(), ended in the reverse order.
struct Appliance::Threads {
  Threads(Appliance& of, std::unique_ptr<plc::ModbusServer> modbus_server, plc::PlcExchange& plc_exchange)
      : exchange(plc_exchange),
        server(std::move(modbus_server)),
        vision(of.stages_->work, of.log_, watchdog.add("vision", longest_job_ms(of.settings_), monotonic_us())),
        controller(cycle_config(of.settings_), of.settings_.plc_timeout_ms * 1000LL,
                   {vision, of.stages_->wiring, of.stages_->hub, exchange, of.log_, *of.book_, of.stages_->refused}) {}

  template <class Step>
  std::thread loop(const char* name, RealtimePriority priority, Step step) {
    Watchdog::Beat& beat = watchdog.add(name, kThreadLimit_ms, monotonic_us());
    std::thread thread([this, &beat, priority, step] {
      make_realtime(priority);
      while (!stop) {
        beat(monotonic_us());
        step();
      }
    });
    name_thread(thread, name);
    return thread;
  }

  plc::PlcExchange& exchange;
  std::unique_ptr<plc::ModbusServer> server;
  Watchdog watchdog;
  VisionThread vision;
  Controller controller;
  std::optional<ApplianceCellSide> cell_side;  // where there is a state folder
  std::atomic<bool> stop{false};
  std::thread cycle, plc, service, models;
  std::unique_ptr<service::Service> api;  // null where it is not served
};

std::size_t Appliance::measure(const Settings& settings, Log& log) {
  Arena arena;
  RunBook book;
  const Stages stages(arena, settings, log, book);
  return arena.used_bytes();
}

Appliance::Appliance(const Settings& settings, Log& log)
    : settings_(settings),
      log_(log),
      book_(std::make_unique<RunBook>()),
      block_(measure(settings, log)),
      arena_(block_.data(), block_.bytes()),
      stages_(std::make_unique<Stages>(arena_, settings, log, *book_)) {}

std::string Appliance::budget_text() const {
  std::string text = "memory, from the declared limits (scratch of locating lies over that of decoding):\n";
  char line[96];
  for (const Arena::Share& share : arena_.shares()) {
    std::snprintf(line, sizeof line, "  %-28s %9.2f MB\n", share.name, static_cast<double>(share.bytes) / 1e6);
    text += line;
  }
  std::snprintf(line, sizeof line, "  %-28s %9.2f MB\n", "total", static_cast<double>(arena_.used_bytes()) / 1e6);
  return text + line;
}

Result<void> Appliance::open_state(State state) {
  if (settings_.state.empty()) return {};
  std::vector<std::string> warnings;
  auto kept = state == State::kKeep ? KeptModels::open(settings_, warnings) : KeptModels::look(settings_, warnings);
  for (const std::string& warning : warnings) log_.write(LogLevel::kWarning, "%s", warning.c_str());
  if (!kept) return std::unexpected(kept.error());
  kept_ = std::move(*kept);
  stages_->hub.use(kept_->source(), kept_->memory());
  return {};
}

Result<void> Appliance::open_lines() {
  if (const auto opened = stages_->wiring.open(); !opened) return opened;
  const std::string lines = stages_->wiring.lines_text();
  if (!lines.empty()) {
    log_.write(LogLevel::kInfo, "lines, by libgpiod %s: %s", capture::gpio_library_version(), lines.c_str());
  }
  return {};
}

void Appliance::lock_memory() {
  memory_locked_ = block_.lock();
  if (memory_locked_) {
    log_.write(LogLevel::kInfo, "%.1f MB taken and locked", static_cast<double>(block_.bytes()) / 1e6);
  } else {
    log_.write(LogLevel::kWarning, "%.1f MB taken but not locked: raise the memlock limit (ulimit -l, LimitMEMLOCK=)",
               static_cast<double>(block_.bytes()) / 1e6);
  }
}

SelfTestOf Appliance::self_test_of() const {
  return {.settings = settings_,
          .camera = stages_->camera,
          .wiring = stages_->wiring,
          .projector = stages_->projector,
          .hub = stages_->hub,
          .memory_locked = memory_locked_,
          .memory_bytes = static_cast<std::int64_t>(block_.bytes()),
          .plc_port = {},
          .service_port = {}};
}

service::SelfTestReport Appliance::self_test_alone() {
  memory_locked_ = block_.lock();
  return service::judge(gather_facts_alone(self_test_of(), stages_->camera, stages_->wiring, stages_->projector));
}

service::SelfTestReport Appliance::self_test_running(const Threads& threads) const {
  SelfTestOf of = self_test_of();
  of.plc_port = {service::PortState::kServedHere, settings_.plc_address, threads.server->port(), "",
                 threads.server->clients() > 0};
  if (threads.api != nullptr) {
    of.service_port = {service::PortState::kServedHere, settings_.service_address, threads.api->port(), "", true};
  }
  return service::judge(gather_facts(of));
}

ApplianceCellSide::Neighbours Appliance::cell_side_of(const Threads& threads) {
  return {.source = kept_->source(),
          .hub = stages_->hub,
          .book = *book_,
          .plc = threads.exchange,
          .camera = stages_->camera,
          .trigger = stages_->wiring.trigger(),
          .budget_bytes = block_.bytes(),
          .self_test = [this, &threads] { return self_test_running(threads); }};
}

bool Appliance::can_be_taken_down() const { return !stages_->camera.started() || stages_->camera.tried(); }

void Appliance::tell_priority() {
  const RealtimeSection trial(RealtimePriority::kStream);
  if (trial.is_realtime()) {
    log_.write(LogLevel::kInfo, "camera, trigger, PLC and cycle run at real-time priority");
  } else {
    log_.write(LogLevel::kWarning, "no real-time priority: raise its limit (ulimit -r, LimitRTPRIO=) to %d",
               static_cast<int>(RealtimePriority::kStream));
  }
}

void Appliance::leave_signals_to_supervisor() {
  const sigset_t signals = handled_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

Result<int> Appliance::run() {
  plc::PlcExchange exchange(settings_.float_order == "low-first" ? plc::WordOrder::kLowFirst
                                                                 : plc::WordOrder::kHighFirst);
  auto server = plc::ModbusServer::open({.address = settings_.plc_address,
                                         .port = static_cast<std::uint16_t>(settings_.plc_port),
                                         .max_clients = settings_.plc_max_clients},
                                        exchange);
  if (!server) return std::unexpected(server.error());
  tell_priority();
  log_.write(LogLevel::kInfo, "PLC: Modbus TCP on %s port %u", settings_.plc_address.c_str(), (*server)->port());

  const auto threads = std::make_unique<Threads>(*this, std::move(*server), exchange);
  if (kept_) threads->cell_side.emplace(settings_, cell_side_of(*threads));
  stages_->camera.start();
  stages_->wiring.start();
  stages_->projector.start();
  threads->plc =
      threads->loop("plc", RealtimePriority::kPlc, [&server = *threads->server] { server.poll(kPlcStep_ms); });
  threads->cycle = threads->loop("cycle", RealtimePriority::kCycle, [&controller = threads->controller] {
    controller.step(monotonic_us());
    std::this_thread::sleep_for(std::chrono::milliseconds(kCycleStep_ms));
  });
  threads->service = std::thread([this, &threads = *threads] {
    while (!threads.stop) {
      stages_->recorder.serve(stages_->hub, arena_.shares());
      std::this_thread::sleep_for(std::chrono::milliseconds(kServiceStep_ms));
    }
  });
  name_thread(threads->service, "service");
  threads->models = std::thread([this, &threads = *threads] {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kModelsNice);
    while (!threads.stop) {
      stages_->hub.serve([&threads] { return threads.vision.idle(); });
      if (stages_->camera.state() == capture::CameraState::kReady) stages_->hub.check_camera(stages_->camera.serial());
      std::this_thread::sleep_for(std::chrono::milliseconds(kServiceStep_ms));
    }
  });
  name_thread(threads->models, "models");
  start_api(*threads);
  const int exit_code = supervise(*threads);
  stop(*threads);
  return exit_code;
}

void Appliance::start_api(Threads& threads) {
  if (threads.cell_side && settings_.service_enabled) {
    threads.api = start_api_service(settings_, kept_->store(), *threads.cell_side, log_, threads.watchdog);
  } else {
    log_.write(LogLevel::kInfo, "service: not served: %s",
               threads.cell_side ? "service.enabled is false" : "service.state names no folder");
  }
}

// The codes that the cell tells say what is wrong with a projector; this says what exactly, once.
void Appliance::tell_projector() {
  const projector::ProjectorKeeper& projector = stages_->projector;
  if (!projector.tried() || projector_told_ == projector.code()) return;
  const Error error = projector.last_error();
  projector_told_ = error.code;
  if (error.code != ResultCode::kOk) return log_.write(LogLevel::kWarning, "%s", error.detail);
  const projector::ProjectorFacts facts = projector.facts();
  log_.write(LogLevel::kInfo, "projector: %s%s%s ready%s%s", facts.name.c_str(), facts.device.empty() ? "" : " at ",
             facts.device.c_str(), facts.details.empty() ? "" : ": ", facts.details.c_str());
}

int Appliance::supervise(Threads& threads) {
  ServiceNotify notify;
  notify.tell("READY=1");
  const sigset_t signals = handled_signals();
  std::int64_t told_us = 0;
  for (;;) {
    tell_projector();
    log_.drain(STDERR_FILENO);
    const std::int64_t now_us = monotonic_us();
    const plc::ApplianceRegisters shown = threads.exchange.published();
    notify.tell_state(shown.state, shown.state == CellState::kFault ? shown.fault_code : shown.last_code);
    if (const char* hung = threads.watchdog.hung(now_us)) {
      log_.write(LogLevel::kFault, "the %s thread hangs: ending, so that the belt's permission falls", hung);
      log_.drain(STDERR_FILENO);
      std::_Exit(kExitHung);  // nothing can be joined; the service manager starts us anew
    }
    if (notify.watchdog_us() > 0 && now_us - told_us > notify.watchdog_us()) {
      notify.tell("WATCHDOG=1");
      told_us = now_us;
    }
    const timespec patience{0, kSupervise_ms * 1'000'000};
    const int signal = sigtimedwait(&signals, nullptr, &patience);
    if (signal == SIGHUP) {
      log_.write(LogLevel::kInfo, "told to read the model files anew");
      stages_->hub.reload();
    } else if (signal > 0) {
      log_.write(LogLevel::kInfo, "stopping on signal %d", signal);
      notify.tell("STOPPING=1");
      return 0;
    }
  }
}

// First the cell is made safe: no offer, no permission; then the threads end.
void Appliance::stop(Threads& threads) {
  threads.vision.ask_to_stop();
  threads.stop = true;
  threads.cycle.join();
  threads.exchange.publish({});
  stages_->wiring.permit_belt(false);
  threads.plc.join();
  threads.server.reset();
  if (!threads.vision.wait_stopped(kStop_ms)) {
    log_.write(LogLevel::kWarning, "locating was cut off");
    write_summary_file();
    log_.drain(STDERR_FILENO);
    std::_Exit(0);  // it cannot be interrupted, and nothing of it is needed any more
  }
  if (threads.api != nullptr && !threads.api->stop(kStopApi_ms)) {
    log_.write(LogLevel::kWarning, "service: a request was cut off");
    write_summary_file();
    log_.drain(STDERR_FILENO);
    std::_Exit(0);  // whatever it was, the store holds the old or the new version
  }
  threads.service.join();
  threads.models.join();
  write_summary_file();
  log_.write(LogLevel::kInfo, "stopped");
  log_.drain(STDERR_FILENO);
}

void Appliance::write_summary_file() const {
  if (settings_.summary.empty()) return;
  const auto written = write_summary(from_settings(settings_, settings_.summary), *book_, arena_.shares());
  if (!written) log_.write(LogLevel::kWarning, "no summary: %s", written.error().detail);
}

}  // namespace beltpick::app
