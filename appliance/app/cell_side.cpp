#include "app/cell_side.hpp"

#include <malloc.h>

#include "app/controller.hpp"

namespace beltpick::app {

service::CellStatus ApplianceCellSide::status() const {
  const plc::ApplianceRegisters shown = to_.plc.published();
  const plc::PlcView plc = to_.plc.view();
  const ModelHub::InUse in_use = to_.hub.in_use();
  const RunBook::Counts counts = to_.book.counts();
  service::CellStatus status;
  status.state = state_name(shown.state);
  status.last_code = shown.last_code;
  status.fault_code = shown.fault_code;
  status.model_code = to_.hub.code();
  status.recipe = to_.hub.active_recipe();
  status.recipe_name = in_use.recipe_name;
  status.in_use = in_use.items;
  status.camera_ready = to_.camera.state() == capture::CameraState::kReady;
  if (status.camera_ready) status.camera_serial = to_.camera.serial();
  status.trigger_ready = to_.trigger.connected();
  const std::int64_t silent_us = monotonic_us() - plc.heartbeat_changed_us;
  status.plc_connected = plc.heard && silent_us <= settings_.plc_timeout_ms * 1000LL;
  const auto number = [](int count) { return static_cast<std::uint64_t>(count); };
  status.pixels = to_.book.pixels();
  status.belt_nearer_mm = to_.book.belt_nearer_mm();
  status.cycles = number(counts.cycles);
  status.captures = number(counts.captures);
  status.offers = number(counts.offers);
  status.picked = number(counts.picked);
  status.faults = number(counts.faults);
  status.uptime_s = since_start_.elapsed_ms() / 1000.0;
  status.memory_budget_mb = static_cast<double>(to_.budget_bytes) / 1e6;
  status.memory_resident_mb = resident_mb();
  return status;
}

ModelJudge ApplianceCellSide::judge_now() const {
  return {to_.source, settings_, {to_.hub.active_recipe(), to_.hub.in_use().camera_serial}};
}

Result<void> ApplianceCellSide::judge(const service::ItemId& id, std::string_view bytes,
                                      std::vector<std::string>& warnings) {
  auto judged = judge_now().judge(id, bytes, warnings);
  ::malloc_trim(0);  // what reading took would otherwise stay resident for good
  return judged;
}

Result<void> ApplianceCellSide::judge_removal(const service::ItemId& id) { return judge_now().judge_removal(id); }

}  // namespace beltpick::app
