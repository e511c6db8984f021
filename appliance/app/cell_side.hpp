// ApplianceCellSide: the appliance as its service sees it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/model_hub.hpp"
#include "app/model_judge.hpp"
#include "app/run_book.hpp"
#include "app/settings.hpp"
#include "base/clock.hpp"
#include "capture/camera.hpp"
#include "capture/trigger_source.hpp"
#include "plc/plc_exchange.hpp"
#include "service/cell_side.hpp"

namespace beltpick::app {

class ApplianceCellSide : public service::CellSide {
 public:
  struct Neighbours {
    const ModelSource& source;  // the store
    ModelHub& hub;
    const RunBook& book;
    const plc::PlcExchange& plc;
    const capture::Camera& camera;
    const capture::TriggerSource& trigger;
    std::size_t budget_bytes = 0;
    std::function<service::SelfTestReport()> self_test;
  };
  ApplianceCellSide(const Settings& settings, const Neighbours& neighbours) : settings_(settings), to_(neighbours) {}

  [[nodiscard]] service::CellStatus status() const override;
  Result<void> judge(const service::ItemId& id, std::string_view bytes, std::vector<std::string>& warnings) override;
  Result<void> judge_removal(const service::ItemId& id) override;
  void changed(const service::ItemId&) override { to_.hub.reload(); }
  service::SelfTestReport self_test() override { return to_.self_test(); }

 private:
  [[nodiscard]] ModelJudge judge_now() const;

  const Settings& settings_;
  Neighbours to_;
  Stopwatch since_start_;
};

}  // namespace beltpick::app
