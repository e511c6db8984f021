// A short run of a fuzz target under ctest, by any compiler: the inputs that were worth keeping, and as many random
// ones of a fixed seed as it is told.
//   fuzz_<target> <folder of inputs> <random inputs>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "base/random.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
// What no input reached; null when nothing is missing.
const char* fuzz_shortfall();

namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<Bytes> kept_inputs(const char* folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<Bytes> inputs;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    inputs.push_back(Bytes{std::istreambuf_iterator<char>(file), {}});
  }
  return inputs;
}

// A kept input with some bytes changed, put in or taken away; now and then only chance.
Bytes random_input(beltpick::Random& random, const std::vector<Bytes>& kept) {
  Bytes input = kept[random.below(static_cast<std::uint32_t>(kept.size()))];
  if (random.below(8) == 0) input.assign(random.below(200), 0);
  const std::uint32_t changes = 1 + random.below(12);
  for (std::uint32_t i = 0; i < changes; ++i) {
    const auto at = random.below(static_cast<std::uint32_t>(input.size()) + 1);
    const auto byte = static_cast<std::uint8_t>(random.below(256));
    const std::uint32_t how = random.below(4);
    if (how == 0) input.insert(input.begin() + at, byte);
    if (at == input.size()) continue;
    if (how == 1) input.erase(input.begin() + at);
    if (how >= 2) input[at] = byte;
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "expected <folder of inputs> <random inputs>\n");
    return 2;
  }
  const std::vector<Bytes> kept = kept_inputs(argv[1]);
  for (const Bytes& input : kept) LLVMFuzzerTestOneInput(input.data(), input.size());
  beltpick::Random random(17);
  const long more = std::atol(argv[2]);
  for (long i = 0; i < more; ++i) {
    const Bytes input = random_input(random, kept);
    LLVMFuzzerTestOneInput(input.data(), input.size());
  }
  std::printf("%zu kept and %ld random inputs\n", kept.size(), more);
  if (const char* missing = fuzz_shortfall()) {
    std::fprintf(stderr, "the inputs reached too little: %s\n", missing);
    return 1;
  }
  return 0;
}
