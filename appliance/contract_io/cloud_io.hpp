// Organised clouds: CLOUD (.npy) in and out, and what is made of a range image to look at (.ply, range.png).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

// A range image that owns its points; camera frame, mm, z = 0 where nothing was measured.
struct Cloud {
  int rows = 0;
  int cols = 0;
  std::vector<Vec3f> point_mm;

  // sigma_mm and texture are empty views.
  [[nodiscard]] RangeImage view() { return {{point_mm.data(), rows, cols}, {}, {}}; }
};

// Reads height x width x 3 float32 in mm. A point with a NaN, an infinity or z <= 0 becomes "not measured"; warns where
// points lie behind the camera or the unit looks like metres. Errors as read_npy; kTooFewPoints where nothing is
// measured.
Result<Cloud> read_cloud(const std::filesystem::path& path, Warnings& warnings);
Result<Cloud> decode_cloud(std::string_view bytes, const std::string& name, Warnings& warnings);

// cloud.npy: float32 height x width x 3, NaN where nothing was measured.
Result<void> write_cloud_npy(const std::filesystem::path& path, const RangeImage& range);

// cloud.ply: binary little-endian, float x y z, uchar intensity (255 where there is no texture), valid points only.
Result<void> write_cloud_ply(const std::filesystem::path& path, const RangeImage& range);

// range.png: 16-bit, camera z in counts of kRangePngCountMm, 0 = none; what is too far is clamped.
inline constexpr float kRangePngCountMm = 0.02F;
Result<void> write_range_png(const std::filesystem::path& path, const RangeImage& range);

}  // namespace beltpick::contract_io
