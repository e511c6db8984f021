// Counts what the capture thread takes from the heap over whole captures.
#include <atomic>
#include <cstdlib>

#include "rig.hpp"

using namespace rig;

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);

namespace {

thread_local bool counted = false;
std::atomic<int> allocations{0};

void count() {
  if (counted) ++allocations;
}

}  // namespace

// Every allocation of the program passes here, operator new included.
extern "C" void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t number, std::size_t size) {
  count();
  return __libc_calloc(number, size);
}
extern "C" void* realloc(void* block, std::size_t size) {
  count();
  return __libc_realloc(block, size);
}

TEST_CASE("the counter sees an allocation", "[allocations]") {
  counted = true;
  allocations = 0;
  std::free(std::malloc(7));
  auto number = std::make_unique<int>(7);
  counted = false;
  CHECK(allocations == 2);
}

TEST_CASE("a capture allocates nothing, be it good or not", "[allocations]") {
  Cell cell;
  Appliance appliance(cell);
  REQUIRE(appliance.capture() == ResultCode::kOk);  // each thread may set up what it keeps
  allocations = 0;
  for (int i = 0; i < 20; ++i) {
    if (i == 10) cell.camera->inject(virtual_cell::gige::FrameFault::kLoseFrame, 5);
    counted = true;
    const auto report = appliance.run();
    counted = false;
    CHECK(report.has_value() == (i != 10));
  }
  CHECK(allocations == 0);
}
