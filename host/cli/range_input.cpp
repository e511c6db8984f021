#include "range_input.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/mesh_io.hpp"
#include "pipeline/lens_fit.hpp"
#include "pipeline/pipeline.hpp"
#include "scans/organise.hpp"

namespace beltpick::cli {

Result<std::unique_ptr<RangeInput>> RangeInput::read(const std::string& path, const std::string& calibration,
                                                     contract_io::Warnings& warnings, bool quiet) {
  std::unique_ptr<RangeInput> input(new RangeInput);
  const std::filesystem::path extension = std::filesystem::path(path).extension();
  if (extension == ".ply") {
    if (auto done = input->read_points(path); !done) return std::unexpected(done.error());
    return input;
  }
  const bool cloud = extension == ".npy";
  if (!cloud && calibration.empty()) {
    return failure(ResultCode::kUsage, "%s: a capture needs --calibration: points come from the geometry",
                   path.c_str());
  }
  const auto done = cloud ? input->read_cloud(path, warnings) : input->read_capture(path, calibration, warnings, quiet);
  if (!done) return std::unexpected(done.error());
  return input;
}

Result<void> RangeInput::read_capture(const std::string& path, const std::string& calibration,
                                      contract_io::Warnings& warnings, bool quiet) {
  auto geometry = contract_io::read_calibration(calibration, warnings);
  if (!geometry) return std::unexpected(geometry.error());
  auto measured = MeasuredCapture::make(path, *geometry, warnings, quiet);
  if (!measured) return std::unexpected(measured.error());
  measured_ = std::move(*measured);
  range_ = measured_->range();
  lens_ = geometry->camera;
  id_ = measured_->header().id;
  calibration_id_ = geometry->id;
  projector_mm_ = pipeline::projector_position_mm(*geometry);
  stage_times_ = {{Stage::kDecode, measured_->timing().decode_ms}, {Stage::kRange, measured_->timing().range_ms}};
  return {};
}

Result<void> RangeInput::read_cloud(const std::string& path, contract_io::Warnings& warnings) {
  auto cloud = contract_io::read_cloud(path, warnings);
  if (!cloud) return std::unexpected(cloud.error());
  cloud_ = std::move(*cloud);
  range_ = cloud_.view();
  const auto lens = pipeline::fit_lens(range_);
  if (!lens) return failure(lens.error().code, "%s: %s", path.c_str(), lens.error().detail);
  lens_ = *lens;
  id_ = std::filesystem::path(path).stem().string();
  shade();
  return {};
}

Result<void> RangeInput::read_points(const std::string& path) {
  auto cloud = contract_io::read_mesh(path, 1.0);
  if (!cloud) return std::unexpected(cloud.error());
  if (!cloud->face.empty()) {
    return failure(ResultCode::kFormatInvalid, "%s: expected a scan's points, found a mesh of %zu faces", path.c_str(),
                   cloud->face.size());
  }
  auto organised = scans::organise(*cloud, path);
  if (!organised) return std::unexpected(organised.error());
  lens_ = organised->lens;
  cloud_ = {organised->rows, organised->cols, std::move(organised->point_mm)};
  range_ = cloud_.view();
  id_ = std::filesystem::path(path).stem().string();
  shade();
  return {};
}

// Lambert's law with the light at the camera.
void RangeInput::shade() {
  const auto& points = range_.point_mm;
  shaded_.assign(points.size(), 0);
  for (int row = 0; row + 1 < points.rows; ++row) {
    for (int col = 0; col + 1 < points.cols; ++col) {
      if (!range_.valid(row, col) || !range_.valid(row + 1, col) || !range_.valid(row, col + 1)) continue;
      const Vec3f& here = points(row, col);
      const Vec3f normal = (points(row, col + 1) - here).cross(points(row + 1, col) - here).normalized();
      const float cosine = std::abs(normal.dot(here.normalized()));
      shaded_[static_cast<std::size_t>(row) * static_cast<std::size_t>(points.cols) + static_cast<std::size_t>(col)] =
          static_cast<std::uint8_t>(40.0F + 200.0F * cosine);
    }
  }
}

ImageView<const std::uint8_t> RangeInput::picture() const {
  if (measured_) return measured_->code().texture;
  return {shaded_.data(), range_.point_mm.rows, range_.point_mm.cols};
}

std::uint64_t RangeInput::seed() const {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (const char c : id_) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

}  // namespace beltpick::cli
