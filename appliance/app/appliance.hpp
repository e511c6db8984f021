// Appliance: everything wired together: memory, devices, threads; from start to a clean stop.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "app/capture_and_locate.hpp"
#include "app/cell_side.hpp"
#include "app/controller.hpp"
#include "app/kept_models.hpp"
#include "app/log.hpp"
#include "app/model_hub.hpp"
#include "app/projector_choice.hpp"
#include "app/recorder.hpp"
#include "app/run_book.hpp"
#include "app/self_test.hpp"
#include "app/service_notify.hpp"
#include "app/settings.hpp"
#include "app/vision_thread.hpp"
#include "app/watchdog.hpp"
#include "app/wiring.hpp"
#include "plc/modbus_server.hpp"

namespace beltpick::app {

// All that takes memory from the arena, in the order in which it does. Made twice: to measure, and for real.
struct Stages {
  Stages(Arena& arena, const Settings& settings, Log& log, RunBook& book);

  ModelHub hub;
  capture::Camera camera;
  Wiring wiring;
  projector::ProjectorKeeper projector;
  KeptPages pages;
  capture::SteppedTrigger stepped;  // where the projector leads
  Recorder recorder;
  RefusedGrasps refused;
  CaptureAndLocate work;
};

class Appliance {
 public:
  // Takes all memory there will be. Throws std::bad_alloc where there is not so much.
  Appliance(const Settings& settings, Log& log);

  // What each part of the appliance took, as a table of lines for a person.
  [[nodiscard]] std::string budget_text() const;
  // Locks the memory; warns where the system does not allow it.
  void lock_memory();
  // Opens the state folder, where the configuration names one; its store then is where models come from. kLook writes
  // nothing. Errors: the folder cannot be read or made.
  enum class State : std::uint8_t { kKeep, kLook };
  Result<void> open_state(State state);
  // Reads calibration, cell, recipes and templates. The appliance runs without them, but refuses to start a cycle.
  Result<void> load() { return stages_->hub.load(); }

  // After load(): tests camera, trigger box, network, files and limits without running; takes some seconds.
  service::SelfTestReport self_test_alone();
  // False where opening the camera has not ended yet: then nothing can be taken down, the process has to end.
  [[nodiscard]] bool can_be_taken_down() const;

  // Takes the digital lines of this PC that are configured. Errors: kLineNotFound, kLineInUse.
  Result<void> open_lines();

  // What happened so far.
  [[nodiscard]] const RunBook& book() const { return *book_; }

  // Has this thread, and those that it makes from now on, block SIGTERM, SIGINT and SIGHUP: run() waits for them, and
  // any thread that did not block them would be ended by them, and the process with it. To be called before the first
  // Appliance is made, whose workers and libraries make threads.
  static void leave_signals_to_supervisor();

  // Opens the PLC's port and runs until SIGTERM or SIGINT; SIGHUP reads the model files anew. Returns the process's
  // exit code: 0 after a clean stop, 3 after a thread has hung. Error: the port cannot be had.
  Result<int> run();

 private:
  struct Threads;

  static std::size_t measure(const Settings& settings, Log& log);
  void tell_priority();
  [[nodiscard]] SelfTestOf self_test_of() const;
  [[nodiscard]] service::SelfTestReport self_test_running(const Threads& threads) const;
  ApplianceCellSide::Neighbours cell_side_of(const Threads& threads);
  void start_api(Threads& threads);
  int supervise(Threads& threads);
  void tell_projector();
  void stop(Threads& threads);
  void write_summary_file() const;

  const Settings& settings_;
  Log& log_;
  std::unique_ptr<RunBook> book_;
  ArenaBlock block_;
  bool memory_locked_ = false;
  std::optional<ResultCode> projector_told_;  // what the log has of it
  Arena arena_;
  std::unique_ptr<Stages> stages_;
  std::unique_ptr<KeptModels> kept_;  // null without a state folder
};

}  // namespace beltpick::app
