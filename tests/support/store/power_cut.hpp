// What may be on a disk after a power cut. Only what was flushed is sure to be there: of a file's bytes since its last
// fsync any number may have arrived, or zeros in their place; of a folder's changes since its last fsync any of them,
// in any order. That is what POSIX leaves open; file systems do better, and so a store that stands this stands them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "support/store/disk_script.hpp"

namespace beltpick::test {

// Files by path below the root; a folder ends with '/'.
using DiskImage = std::map<std::string, std::string>;

DiskImage image_of(const std::filesystem::path& root);
void write_image(const DiskImage& image, const std::filesystem::path& root);

// Every image that can be there after a power cut once `done` of `calls` were made, begun on `before`, whose files were
// at `root`. Of bytes on their way every `byte_step`th cut is taken. Images that come up twice are visited once.
void each_power_cut(const DiskImage& before, const std::filesystem::path& root, const std::vector<DiskCall>& calls,
                    std::size_t done, std::size_t byte_step, const std::function<void(const DiskImage&)>& visit);

}  // namespace beltpick::test
