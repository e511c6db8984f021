// Fuzzes the firmware's core: wire, pins and clock move as the input says; outputs stay safe and every state has a way
// out.
#include "device_world.hpp"

namespace {
fuzz::Reached reached;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Input input(bytes, size);
  fuzz::World world(input);
  for (int steps = 0; !input.ended(); ++steps) {
    world.step(input);
    if (steps % 16 == 15) fuzz::World(world).check_way_out();
  }
  world.check_way_out();
  reached.running += world.reached().running;
  reached.done += world.reached().done;
  reached.faults += world.reached().faults;
  reached.refusals += world.reached().refusals;
  return 0;
}

const char* fuzz_shortfall() {
  if (reached.refusals == 0) return "no request refused";
  if (reached.running == 0) return "no sequence started";
  if (reached.done == 0) return "no sequence done";
  return reached.faults == 0 ? "no fault" : nullptr;
}
