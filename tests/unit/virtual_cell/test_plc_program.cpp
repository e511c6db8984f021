// The virtual PLC against the appliance's own cycle and Modbus server, with a stand-in for eyes and hands.
#include <atomic>
#include <catch2/catch.hpp>
#include <thread>
#include <vector>

#include "base/clock.hpp"
#include "cycle/cycle.hpp"
#include "plc/modbus_server.hpp"
#include "plc/plc_exchange.hpp"
#include "virtual_cell/world/plc_program.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

// A belt of views with so many parts each; every pick succeeds unless told otherwise.
struct StandInPlant final : Plant {
  std::vector<int> views;
  std::size_t next = 0;
  std::atomic<int> in_view{0};
  std::atomic<bool> line_stopped{true};
  std::atomic<bool> emergency_stop{false};
  std::atomic<int> exposed{0};
  int blocked = 0;  // picks to fail
  std::vector<CellFault> broken;

  bool bring_next_parts() override {
    if (next >= views.size()) return false;
    in_view = views[next++];
    return true;
  }
  void set_belt_stopped_line(bool stopped) override { line_stopped = stopped; }
  void set_emergency_stop_line(bool pressed) override { emergency_stop = pressed; }
  PickResult pick(const Offer& offer) override {
    REQUIRE(offer.whole);
    if (blocked > 0) {
      --blocked;
      return {.outcome = PickOutcome::kBlocked};
    }
    --in_view;
    return {.outcome = PickOutcome::kPicked};
  }
  void miss() override {}
  int parts_in_view() const override { return in_view; }
  int exposures() const override { return exposed; }
  void break_device(CellFault fault) override { broken.push_back(fault); }
  void mend_devices() override {}
};

// The appliance without camera and pipeline: a capture takes 60 ms, and locating finds what lies in view.
class StandInAppliance {
 public:
  explicit StandInAppliance(StandInPlant& plant) : plant_(plant), cycle_(config()) {
    plc::ModbusServerConfig server;
    server.address = "127.0.0.1";
    server.port = 0;
    auto opened = plc::ModbusServer::open(server, exchange_);
    REQUIRE(opened);
    server_ = std::move(*opened);
    server_thread_ = std::thread([this] {
      while (!stop_) server_->poll(5);
    });
    cycle_thread_ = std::thread([this] {
      while (!stop_) step();
    });
  }
  ~StandInAppliance() {
    stop_ = true;
    server_thread_.join();
    cycle_thread_.join();
  }
  int port() const { return server_->port(); }

 private:
  static cycle::CycleConfig config() {
    cycle::CycleConfig config;
    config.rest.settle_us = 20'000;
    return config;
  }

  void step() {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const plc::PlcView view = exchange_.view();
    cycle::CycleInputs in;
    in.now_us = monotonic_us();
    in.emergency_stop = plant_.emergency_stop;
    in.line_belt_stopped = plant_.line_stopped;
    in.register_belt_stopped = view.belt_stopped;
    in.robot_clear = view.robot_clear;
    in.plc_silent = view.heard && in.now_us - view.heartbeat_changed_us > 400'000;
    if (capture_until_us_ > 0 && in.now_us > capture_until_us_) {
      in.capture = {true, number_, ResultCode::kOk};
      capture_until_us_ = 0;
    }
    if (locate_) in.locate = {true, number_, ResultCode::kOk, parts_, 0, ResultCode::kOk};
    locate_ = false;
    if (view.command && view.command->ticket != ticket_) {
      in.command = view.command->command;
      in.command_argument = view.command->argument;
    }
    carry_out(cycle_.step(in), view);
  }

  void carry_out(const cycle::Actions& actions, const plc::PlcView& view) {
    std::optional<plc::PlcExchange::Answer> answer;
    for (const cycle::Action& action : actions.list()) {
      if (action.kind == cycle::ActionKind::kStartCapture) {
        number_ = action.number;
        capture_until_us_ = monotonic_us() + 60'000;
        plant_.exposed += 10;
      }
      if (action.kind == cycle::ActionKind::kAbortCapture) capture_until_us_ = 0;
      if (action.kind == cycle::ActionKind::kStartProcessing) {
        LocatedPart part;
        part.grasp_index = 0;
        parts_.assign(static_cast<std::size_t>(plant_.in_view), part);
        locate_ = true;
      }
      if (action.kind == cycle::ActionKind::kAnswerCommand) {
        ticket_ = view.command->ticket;
        answer = plc::PlcExchange::Answer{ticket_, action.code};
      }
    }
    publish(answer);
  }

  void publish(std::optional<plc::PlcExchange::Answer> answer) {
    const cycle::CycleStatus& status = cycle_.status();
    plc::ApplianceRegisters registers;
    registers.state = status.state;
    registers.status_bits = status.bits();
    registers.fault_code = status.fault_code;
    registers.last_code = status.last_code;
    registers.capture = status.capture;
    registers.offer.sequence = status.offer_sequence;
    registers.offer.part.rotation_wxyz = {1, 0, 0, 0};
    registers.offer.grasp.rotation_wxyz = {1, 0, 0, 0};
    exchange_.publish(registers, answer);
  }

  StandInPlant& plant_;
  plc::PlcExchange exchange_{plc::WordOrder::kHighFirst};
  std::unique_ptr<plc::ModbusServer> server_;
  cycle::Cycle cycle_;
  std::vector<LocatedPart> parts_;
  std::int64_t capture_until_us_ = 0;
  std::uint16_t number_ = 0;
  std::uint32_t ticket_ = 0;
  bool locate_ = false;
  std::atomic<bool> stop_{false};
  std::thread server_thread_;
  std::thread cycle_thread_;
};

CellReport run(StandInPlant& plant, FaultPlan plan) {
  StandInAppliance appliance(plant);
  auto link = PlcLink::connect("127.0.0.1", appliance.port(), 2000);
  REQUIRE(link);
  PlcProgramOptions options;
  options.answer_timeout_ms = 5000;
  const std::atomic<bool> stop{false};
  return PlcProgram(**link, plant, std::move(plan), options, stop).run();
}

}  // namespace

TEST_CASE("a belt is picked empty, and a blocked pick is tried again") {
  StandInPlant plant;
  plant.views = {2, 0, 3};
  plant.blocked = 1;
  const CellReport report = run(plant, {});
  CHECK(report.finished);
  CHECK(report.stopped_by.empty());
  CHECK(report.parts == 5);
  CHECK(report.picked == 5);
  CHECK(report.tray == 0);
  CHECK(report.blocked == 1);
  CHECK(report.unsafe == 0);
  CHECK(report.views.size() == 3);
}

TEST_CASE("the faults that a PLC can stage are answered by their codes, and the belt is finished") {
  const std::string name =
      GENERATE("belt-moves-capture", "belt-moves-offer", "robot-in-view", "failed-pick", "plc-silent", "e-stop");
  StandInPlant plant;
  plant.views = {1, 1};
  FaultPlan plan;
  REQUIRE(plan.add(name));
  const CellReport report = run(plant, std::move(plan));
  INFO(name << " " << report.stopped_by);
  CHECK(report.finished);
  CHECK(report.picked == 2);
  CHECK(report.unsafe == 0);
  REQUIRE(report.faults.size() == 1);
  INFO((report.faults[0].codes.empty() ? 0 : report.faults[0].codes[0]));
  CHECK(report.faults[0].answered);
  CHECK(report.faults[0].recovered);
}

TEST_CASE("a fault plan refuses what it does not know, and draws the same faults for the same seed") {
  FaultPlan plan;
  CHECK_FALSE(plan.add("earthquake"));
  CHECK_FALSE(plan.add("e-stop@x"));
  REQUIRE(plan.add("e-stop@2"));
  CHECK_FALSE(plan.for_cycle(0));
  CHECK(plan.for_cycle(2) == CellFault::kEmergencyStop);
  FaultPlan a(0.5, 7);
  FaultPlan b(0.5, 7);
  int hits = 0;
  for (int i = 0; i < 100; ++i) {
    const auto drawn = a.for_cycle(i);
    CHECK(drawn == b.for_cycle(i));
    hits += drawn.has_value();
  }
  CHECK(hits > 30);
  CHECK(hits < 70);
}
