#include "virtual_cell/world/fault_plan.hpp"

#include <charconv>

namespace beltpick::virtual_cell {

const CellFaultEntry& fault_entry(CellFault fault) { return kCellFaults[static_cast<std::size_t>(fault)]; }

std::string fault_names() {
  std::string names;
  for (const CellFaultEntry& entry : kCellFaults) {
    if (!names.empty()) names += ", ";
    names += entry.name;
  }
  return names;
}

const CellFaultEntry* find_fault(std::string_view name) {
  for (const CellFaultEntry& entry : kCellFaults) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

Result<void> FaultPlan::add(std::string_view text) {
  const std::size_t at = text.find('@');
  const std::string_view name = text.substr(0, at);
  int cycle = 0;
  bool number_good = true;
  if (at != std::string_view::npos) {
    const std::string_view digits = text.substr(at + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), cycle);
    number_good = error == std::errc{} && end == digits.data() + digits.size() && cycle >= 0;
  }
  if (const CellFaultEntry* entry = find_fault(name); entry != nullptr && number_good) {
    named_[cycle] = entry->fault;
    return {};
  }
  return failure(ResultCode::kUsage, "fault '%.*s': expected NAME or NAME@CYCLE with NAME one of %s",
                 static_cast<int>(text.size()), text.data(), fault_names().c_str());
}

std::optional<CellFault> FaultPlan::for_cycle(int cycle) {
  // Drawn even when a named fault comes first, so that naming one does not shift the others.
  const bool hit = random_.uniform() < rate_;
  const auto drawn = static_cast<CellFault>(random_.below(kCellFaults.size()));
  if (const auto named = named_.find(cycle); named != named_.end()) return named->second;
  if (hit) return drawn;
  return std::nullopt;
}

}  // namespace beltpick::virtual_cell
