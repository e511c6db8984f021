// PlcProgram: what the virtual PLC does: belt, robot and the four-phase handshake with the appliance, view after view,
// until the belt is empty. It also stages those faults that are a PLC's own.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "base/result.hpp"
#include "virtual_cell/world/cell_report.hpp"
#include "virtual_cell/world/fault_plan.hpp"
#include "virtual_cell/world/plant.hpp"
#include "virtual_cell/world/plc_link.hpp"

namespace beltpick::virtual_cell {

struct PlcProgramOptions {
  int answer_timeout_ms = 30'000;  // for an echo, an offer, the end of a fault
  int max_restarts = 6;            // of one view after faults; then its parts travel on
  std::uint16_t recipe = 0;        // selected at the start; 0: the one that is active
  // Told when parts lie in view, and when they are done.
  std::function<void(int view)> on_view_begin;
  std::function<void(const ViewRecord&)> on_view_end;
};

class PlcProgram {
 public:
  PlcProgram(PlcLink& link, Plant& plant, FaultPlan plan, PlcProgramOptions options, const std::atomic<bool>& stop);

  // Runs the whole belt. The report says what happened even where it did not finish.
  CellReport run();

 private:
  enum class ViewEnd { kReleased, kFaulted, kStopped };

  // All answer false when the run must end; the reason stands in the report then.
  bool begin();
  bool run_view();
  ViewEnd run_cycle(ViewRecord& view);
  bool release_belt();
  bool recover();
  bool serve_offer(const ApplianceRegisters& seen, ViewRecord& view);
  void stage_before_start();
  void stage_while_capturing(const ApplianceRegisters& seen);
  bool stage_at_offer(const ApplianceRegisters& seen);
  void undo_fault();
  void close_fault(bool recovered);

  std::optional<ApplianceRegisters> look();
  // Four-phase: command, echo, zero, echo cleared. The result code, or nothing when no answer came.
  std::optional<ResultCode> command(PlcCommand command, std::uint16_t argument = 0);
  bool await_echo(PlcCommand command, ApplianceRegisters& seen);
  bool hold_belt(bool stopped);
  bool show_robot_clear(bool clear);
  bool write_status();
  bool give_up(const std::string& why);
  void note_code(std::uint16_t code);

  PlcLink& link_;
  Plant& plant_;
  FaultPlan plan_;
  PlcProgramOptions options_;
  const std::atomic<bool>& stop_;
  CellReport report_;
  bool belt_stopped_ = true;
  bool robot_clear_ = true;
  int served_sequence_ = -1;
  int exposures_at_start_ = 0;
  std::uint16_t last_code_at_start_ = 0;
  std::optional<std::uint16_t> captures_before_;  // this view
  std::optional<FaultRecord> fault_;              // of this view, if it is hit
  bool staged_ = false;                           // it was done to the cell
};

}  // namespace beltpick::virtual_cell
