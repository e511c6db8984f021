// Bytes of files that captures are made of, and zips of them, for tests.
#pragma once

#include <zip.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace beltpick::test {

inline std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i, value >>= 8U) out += static_cast<char>(value & 0xffU);
  return out;
}

// A BMP with a 40-byte header around palette and pixel bytes.
inline std::string bmp(int width, int height, int bits, const std::string& palette, const std::string& pixels,
                       std::uint32_t compression = 0) {
  const std::size_t at = 54 + palette.size();
  return "BM" + little(at + pixels.size(), 4) + little(0, 4) + little(at, 4) + little(40, 4) +
         little(static_cast<std::uint32_t>(width), 4) + little(static_cast<std::uint32_t>(height), 4) + little(1, 2) +
         little(static_cast<std::uint64_t>(bits), 2) + little(compression, 4) + little(0, 20) + palette + pixels;
}

// A zip of the files of `folder`, each under `prefix` + its name.
inline bool zip_folder(const std::filesystem::path& folder, const std::filesystem::path& archive,
                       const std::string& prefix) {
  int error = 0;
  zip_t* zip = zip_open(archive.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (zip == nullptr) return false;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    zip_file_add(zip, (prefix + entry.path().filename().string()).c_str(),
                 zip_source_file(zip, entry.path().c_str(), 0, -1), 0);
  }
  return zip_close(zip) == 0;
}

}  // namespace beltpick::test
