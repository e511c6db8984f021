#include "contract_io/cloud_io.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/npy_io.hpp"

namespace beltpick::contract_io {
namespace {

constexpr float kNearestPlausibleMm = 20.0F;  // a median below it is a cloud in metres

struct CloudCount {
  std::size_t valid = 0;
  std::size_t behind = 0;
};

CloudCount clean(std::vector<Vec3f>& points_mm) {
  CloudCount count;
  for (Vec3f& point_mm : points_mm) {
    const bool finite = point_mm.allFinite();
    if (finite && point_mm.z() < 0.0F) ++count.behind;
    if (finite && point_mm.z() > 0.0F) {
      ++count.valid;
    } else {
      point_mm.setZero();
    }
  }
  return count;
}

float median_z_mm(const std::vector<Vec3f>& points_mm) {
  std::vector<float> z;
  for (const Vec3f& point_mm : points_mm) {
    if (point_mm.z() > 0.0F) z.push_back(point_mm.z());
  }
  std::nth_element(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(z.size() / 2), z.end());
  return z[z.size() / 2];
}

void warn_of_oddities(const Cloud& cloud, const CloudCount& count, const std::string& name, Warnings& warnings) {
  if (count.behind > 0) {
    warnings.push_back(name + ": " + std::to_string(count.behind) +
                       " points lie behind the camera and are ignored; z must point away from it");
  }
  const float median_mm = median_z_mm(cloud.point_mm);
  if (median_mm < kNearestPlausibleMm) {
    warnings.push_back(name + ": the median distance is " + std::to_string(median_mm) +
                       " mm; a cloud in metres must be multiplied by 1000");
  }
}

}  // namespace

Result<Cloud> decode_cloud(std::string_view bytes, const std::string& name, Warnings& warnings) {
  const auto array = decode_npy<float>(bytes, name, {-1, -1, 3});
  if (!array) return std::unexpected(array.error());
  Cloud cloud;
  cloud.rows = array->shape[0];
  cloud.cols = array->shape[1];
  cloud.point_mm.resize(array->values.size() / 3);
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  std::memcpy(static_cast<void*>(cloud.point_mm.data()), array->values.data(), array->values.size() * sizeof(float));
  const CloudCount count = clean(cloud.point_mm);
  if (count.valid == 0) {
    return failure(
        ResultCode::kTooFewPoints,
        "%s: expected measured points, found none in front of the camera among %zu; check its unit and z axis",
        name.c_str(), cloud.point_mm.size());
  }
  warn_of_oddities(cloud, count, name, warnings);
  return cloud;
}

Result<Cloud> read_cloud(const std::filesystem::path& path, Warnings& warnings) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  return decode_cloud(*bytes, one_line(path.string()), warnings);
}

Result<void> write_cloud_npy(const std::filesystem::path& path, const RangeImage& range) {
  const auto& points = range.point_mm;
  std::vector<float> values;
  values.reserve(points.size() * 3);
  const Vec3f nothing = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (int r = 0; r < points.rows; ++r) {
    for (int c = 0; c < points.cols; ++c) {
      const Vec3f& point_mm = range.valid(r, c) ? points(r, c) : nothing;
      values.insert(values.end(), point_mm.data(), point_mm.data() + 3);
    }
  }
  return write_npy<float>(path, values, {points.rows, points.cols, 3});
}

Result<void> write_cloud_ply(const std::filesystem::path& path, const RangeImage& range) {
  const auto& points = range.point_mm;
  std::string body;
  std::size_t count = 0;
  for (int r = 0; r < points.rows; ++r) {
    for (int c = 0; c < points.cols; ++c) {
      if (!range.valid(r, c)) continue;
      const std::uint8_t intensity = range.texture.empty() ? 255 : range.texture(r, c);
      body.append(reinterpret_cast<const char*>(points(r, c).data()), 3 * sizeof(float));
      body += static_cast<char>(intensity);
      ++count;
    }
  }
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment beltpick, camera frame, mm\nelement vertex " +
      std::to_string(count) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar intensity\n"
      "end_header\n";
  return write_file(path, header + body);
}

Result<void> write_range_png(const std::filesystem::path& path, const RangeImage& range) {
  const auto& points = range.point_mm;
  std::vector<std::uint16_t> counts(points.size());
  std::size_t i = 0;
  for (int r = 0; r < points.rows; ++r) {
    for (int c = 0; c < points.cols; ++c, ++i) {
      if (!range.valid(r, c)) continue;
      counts[i] =
          static_cast<std::uint16_t>(std::clamp(std::round(points(r, c).z() / kRangePngCountMm), 1.0F, 65535.0F));
    }
  }
  return write_png(path, ImageView<const std::uint16_t>(counts.data(), points.rows, points.cols));
}

}  // namespace beltpick::contract_io
