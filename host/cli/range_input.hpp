// RangeInput: the range image that a CAPTURE or a CLOUD gives, with what is known of the camera that took it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contract/calibration.hpp"
#include "contract/locate_result.hpp"
#include "contract_io/cloud_io.hpp"
#include "measured_capture.hpp"

namespace beltpick::cli {

class RangeInput {
 public:
  // `path`: a .npy is a CLOUD, a .ply the points of one (in the frame of the camera that took them), all else a
  // CAPTURE, which needs `calibration`. Errors: kUsage; as MeasuredCapture, read_cloud, fit_lens and organise.
  static Result<std::unique_ptr<RangeInput>> read(const std::string& path, const std::string& calibration,
                                                  contract_io::Warnings& warnings, bool quiet);

  [[nodiscard]] const RangeImage& range() const { return range_; }
  [[nodiscard]] const Lens& lens() const { return lens_; }
  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] const std::string& calibration_id() const { return calibration_id_; }
  [[nodiscard]] std::optional<Vec3> projector_mm() const { return projector_mm_; }
  // From the capture's id, so that the same capture gives the same result.
  [[nodiscard]] std::uint64_t seed() const;
  // Time of decode and range; empty for a cloud.
  [[nodiscard]] const std::vector<LocateReport::StageTime>& stage_times() const { return stage_times_; }
  // Something to draw on: the camera's image, or the cloud as if lit from the camera.
  [[nodiscard]] ImageView<const std::uint8_t> picture() const;

 private:
  RangeInput() = default;
  Result<void> read_capture(const std::string& path, const std::string& calibration, contract_io::Warnings& warnings,
                            bool quiet);
  Result<void> read_cloud(const std::string& path, contract_io::Warnings& warnings);
  Result<void> read_points(const std::string& path);
  void shade();

  std::unique_ptr<MeasuredCapture> measured_;
  contract_io::Cloud cloud_;
  std::vector<std::uint8_t> shaded_;
  RangeImage range_;
  Lens lens_;
  std::string id_, calibration_id_;
  std::optional<Vec3> projector_mm_;
  std::vector<LocateReport::StageTime> stage_times_;
};

}  // namespace beltpick::cli
