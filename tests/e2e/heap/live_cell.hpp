// The virtual cell as a process beside the appliance under test, and what both agree on.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "app/appliance.hpp"
#include "heap_counter.hpp"

namespace live {

// A TCP port that nobody listens on.
std::uint16_t free_port();

// `beltpick simulate --live` with the cell that e2e_cell_setup made.
class VirtualCell {
 public:
  VirtualCell(const std::filesystem::path& run, std::uint16_t plc_port, int parts, int seed, int speed);
  ~VirtualCell();
  VirtualCell(const VirtualCell&) = delete;
  VirtualCell& operator=(const VirtualCell&) = delete;

  // The report, once the belt is empty; null where that takes longer.
  [[nodiscard]] nlohmann::json wait_report(double patience_s) const;
  // Ends the belt where it is and returns the report.
  nlohmann::json stop();

 private:
  std::filesystem::path report_;
  pid_t process_ = 0;
};

std::filesystem::path cell_folder();
beltpick::app::Settings settings_for(const std::filesystem::path& run, std::uint16_t plc_port);

// The appliance in this process, ended by SIGTERM as it always is.
class RunningAppliance {
 public:
  explicit RunningAppliance(const beltpick::app::Settings& settings);

  [[nodiscard]] const beltpick::app::Appliance& operator*() const { return appliance_; }
  [[nodiscard]] const beltpick::app::RunBook& book() const { return appliance_.book(); }
  // Its exit code.
  int stop();

 private:
  // Before any thread is made, so that the supervisor alone gets the signal.
  struct TermBlocked {
    TermBlocked();
  };

  TermBlocked blocked_;
  beltpick::app::Log log_;
  beltpick::app::Appliance appliance_;
  int exit_code_ = -1;
  std::thread supervisor_;
};

bool wait_for_cycles(const beltpick::app::Appliance& appliance, int cycles, double patience_s);

// Prints what every thread took, and checks that the threads of the design live and took nothing.
void check_counted_threads(const std::vector<heap::ThreadCount>& counts);

}  // namespace live
