// CellReport: what a run of the virtual cell came to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "virtual_cell/world/fault_plan.hpp"
#include "virtual_cell/world/plant.hpp"

namespace beltpick::virtual_cell {

struct FaultRecord {
  CellFault fault{};
  int view = 0;
  std::vector<std::uint16_t> codes;  // result codes the appliance told while it lasted, in order
  bool answered = false;             // its own code was among them (none, where none is expected)
  bool recovered = false;            // the view was finished after it
};

// One stop of the belt.
struct ViewRecord {
  int view = 0;
  int parts = 0;
  int picked = 0;
  int left = 0;          // parts that travel to the tray
  int failed_picks = 0;  // crashed or blocked
  int captures = 0;
  int withheld = 0;                 // as the appliance counted at the end
  std::uint16_t withheld_code = 0;  // its reason for the first of them; 0 none
  double first_pose_ms = 0.0;       // from the start command to the first offer; 0 none
  double total_ms = 0.0;
};

struct PickRecord {
  int view = 0;
  PickResult result;
};

struct CellReport {
  int parts = 0;
  int picked = 0;
  int tray = 0;
  int crashes = 0;
  int blocked = 0;  // picks whose way in was not free
  int unsafe = 0;   // reads in which a pose stood or the belt was free though a fault was latched
  bool finished = false;
  std::string stopped_by;  // why it did not finish
  std::vector<ViewRecord> views;
  std::vector<PickRecord> picks;
  std::vector<FaultRecord> faults;
};

}  // namespace beltpick::virtual_cell
