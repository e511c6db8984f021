// A Modbus server with one offer on it for clients that are not ours: prints its port, refuses every command, ends when
// its input ends.
#include <poll.h>
#include <unistd.h>

#include <cstdio>

#include "plc/modbus_server.hpp"

int main() {
  using namespace beltpick;
  plc::PlcExchange exchange(plc::WordOrder::kHighFirst);
  auto server = plc::ModbusServer::open({.address = "127.0.0.1", .port = 0}, exchange);
  if (!server) {
    std::fprintf(stderr, "%s\n", server.error().detail);
    return 1;
  }
  plc::ApplianceRegisters registers;
  registers.state = CellState::kOffering;
  registers.offer.sequence = 41;
  registers.offer.part = {{123.5F, -2.0F, 3.25F}, {1.0F, 0.0F, 0.0F, 0.0F}};
  exchange.publish(registers);
  std::printf("%u\n", static_cast<unsigned>((*server)->port()));
  std::fflush(stdout);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (poll(&input, 1, 0) == 0) {
    (*server)->poll(2);
    if (const auto command = exchange.view().command) {
      exchange.publish(registers, plc::PlcExchange::Answer{command->ticket, ResultCode::kCommandNotAllowed});
    }
  }
  return 0;
}
