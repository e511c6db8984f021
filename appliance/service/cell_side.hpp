// What the service asks of the appliance behind it. The real one is wired in app; tests stand in for it. All of it is
// called from the service's threads only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "service/self_test.hpp"
#include "service/store.hpp"

namespace beltpick::service {

struct ItemInUse {
  ItemId id;
  std::uint32_t version = 0;
};

// A moment of the running cell.
struct CellStatus {
  std::string state;  // as the register table names it
  ResultCode last_code{};
  ResultCode fault_code{};   // kOk where there is none
  ResultCode model_code{};   // why no cycle can be started; kOk where one can
  std::uint16_t recipe = 0;  // active
  std::string recipe_name;
  std::vector<ItemInUse> in_use;
  std::string camera_serial;  // of the one that answers; empty while none does
  bool camera_ready = false;
  bool trigger_ready = false;
  bool plc_connected = false;
  PixelCounts pixels{};                  // of the latest capture; all zero before the first
  std::optional<double> belt_nearer_mm;  // than the cell file has it, as measured of late
  std::uint64_t cycles = 0, captures = 0, offers = 0, picked = 0, faults = 0;
  double uptime_s = 0;
  double memory_budget_mb = 0, memory_resident_mb = 0;
};

class CellSide {
 public:
  virtual ~CellSide() = default;

  [[nodiscard]] virtual CellStatus status() const = 0;

  // Whether the cell could work with `bytes` as this item and with all else as it stands in the store: format,
  // checksum, plausibility, limits, the calibration's camera and projector, what refers to it. What a person should
  // know but does not hinder is added to `warnings`. An error is told to the one who uploads.
  virtual Result<void> judge(const ItemId& id, std::string_view bytes, std::vector<std::string>& warnings) = 0;
  // Whether the cell can do without a template or recipe. Error: kItemInUse naming what needs it.
  virtual Result<void> judge_removal(const ItemId& id) = 0;
  // The store holds something new: it is prepared in the standby half of the model memory and swapped in between
  // cycles; offers are revoked.
  virtual void changed(const ItemId& id) = 0;

  // Runs the self-test; takes up to some seconds.
  virtual SelfTestReport self_test() = 0;
};

}  // namespace beltpick::service
