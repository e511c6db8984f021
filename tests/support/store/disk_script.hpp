// DiskScript: stands between the store and the operating system, counts the calls that change the disk, writes them
// down, and at one of them dies (as by kill -9) or fails.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace beltpick::test {

enum class DiskOp { kCreate, kMakeFolder, kWrite, kSync, kRename, kRemove };

// One call that changes the disk, and succeeded. Paths are absolute.
struct DiskCall {
  DiskOp op{};
  std::filesystem::path path;
  std::filesystem::path to;  // of a rename
  std::string bytes;         // of a write
};

enum class DiskEvent {
  kNone,
  kDieBefore,
  kDieAfter,
  kTear,        // a write does `torn_bytes` of its bytes, then the process dies; other calls die before
  kFail,        // with `error`; a write may have done `torn_bytes` of its bytes in a call before
  kFailOnward,  // the same, and every call after it fails too
};

struct DiskScript {
  DiskEvent event = DiskEvent::kNone;
  int at = 0;  // the call, from 0
  int error = 0;
  std::size_t torn_bytes = 0;
};

// From now on the calls of this process follow the script.
void start_disk_script(const DiskScript& script);
// The calls that succeeded since.
std::vector<DiskCall> stop_disk_script();

}  // namespace beltpick::test
