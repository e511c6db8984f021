// bench_decode_plain CAPTURE PASSES: times the kernels as built for the baseline processor, without a choice of wider
// vector units at run time. Prints "memcpy_ms fold_ms finish_ms" and a checksum of the points, for bench_decode to
// read.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "bench/decode/checksum.hpp"
#include "bench/decode/job.hpp"

int main(int argc, char** argv) {
  using namespace beltpick::bench;
  if (argc != 3) give_up("expected a capture and a number of passes");
  const Loaded loaded = load_frames(argv[1]);
  const beltpick::Calibration calibration = load_calibration(argv[1]);
  Job job(loaded, &calibration, beltpick::decode::kBandRows);
  const Times times = job.time(std::atoi(argv[2]));
  std::printf("%.4f %.4f %.4f %016llx\n", times.memcpy_ms, times.fold_ms, times.finish_ms, checksum(job.range()));
  return 0;
}
