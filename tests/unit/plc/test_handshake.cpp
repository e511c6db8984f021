#include <catch2/catch.hpp>

#include <array>

#include "plc/plc_exchange.hpp"

using namespace beltpick;
using namespace beltpick::plc;

TEST_CASE("four phases: command, echo, zero, echo cleared", "[handshake]") {
  CommandHandshake handshake;
  handshake.written(0, 0);
  CHECK_FALSE(handshake.pending());
  handshake.written(2, 99);
  REQUIRE(handshake.pending());
  CHECK(handshake.pending()->command == 2);
  CHECK(handshake.pending()->argument == 99);
  handshake.answer(handshake.pending()->ticket, ResultCode::kCommandNotAllowed);
  CHECK(handshake.echo() == 2);
  CHECK(handshake.result() == ResultCode::kCommandNotAllowed);
  handshake.written(2, 99);  // still standing: not a new command
  CHECK_FALSE(handshake.pending());
  handshake.written(3, 99);  // without the 0 between: not seen
  CHECK_FALSE(handshake.pending());
  handshake.written(0, 99);
  CHECK(handshake.echo() == 0);
  CHECK(handshake.result() == ResultCode::kOk);
  handshake.written(3, 1);
  REQUIRE(handshake.pending());
  CHECK(handshake.pending()->command == 3);
}

TEST_CASE("the argument is the one that stood when the command was written", "[handshake]") {
  CommandHandshake handshake;
  handshake.written(2, 10);
  handshake.written(2, 11);
  CHECK(handshake.pending()->argument == 10);
}

TEST_CASE("an answer to a withdrawn command does not answer the next one of the same number", "[handshake]") {
  CommandHandshake handshake;
  handshake.written(1, 0);
  const auto ticket = handshake.pending()->ticket;
  handshake.written(0, 0);
  handshake.written(1, 0);
  handshake.answer(ticket, ResultCode::kOk);
  CHECK(handshake.echo() == 0);
  REQUIRE(handshake.pending());
  handshake.answer(handshake.pending()->ticket, ResultCode::kOk);
  CHECK(handshake.echo() == 1);
}

TEST_CASE("the exchange tells status bits and when the heartbeat last changed", "[exchange]") {
  PlcExchange exchange(WordOrder::kHighFirst);
  CHECK_FALSE(exchange.view().heard);
  std::array<std::uint16_t, kHoldingRegisters> holding{};
  holding[2] = 3;
  exchange.holding_written(holding, 100);
  CHECK(exchange.view().heard);
  CHECK((exchange.view().belt_stopped && exchange.view().robot_clear));
  CHECK(exchange.view().heartbeat_changed_us == 100);
  exchange.holding_written(holding, 200);
  CHECK(exchange.view().heartbeat_changed_us == 100);
  holding[3] = 1;
  holding[2] = 2;
  exchange.holding_written(holding, 300);
  CHECK(exchange.view().heartbeat_changed_us == 300);
  CHECK_FALSE(exchange.view().belt_stopped);
}

TEST_CASE("echo and the state it led to appear together", "[exchange]") {
  PlcExchange exchange(WordOrder::kHighFirst);
  std::array<std::uint16_t, kHoldingRegisters> holding{};
  holding[0] = 2;
  exchange.holding_written(holding, 1);
  ApplianceRegisters registers;
  registers.state = CellState::kBeltReleased;
  std::array<std::uint16_t, kInputRegisters> inputs{};
  exchange.copy_inputs(inputs);
  CHECK((inputs[1] == 0 && inputs[3] == 0));
  exchange.publish(registers, PlcExchange::Answer{exchange.view().command->ticket, ResultCode::kOk});
  exchange.copy_inputs(inputs);
  CHECK((inputs[1] == 6 && inputs[3] == 2));
}
