// Good files of every format, for tests to read, break and mutate.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "contract_io/image_io.hpp"
#include "support/capture_files.hpp"
#include "support/one_line.hpp"

namespace beltpick::test {

inline contract_io::GreyImage ramp8(int rows, int cols) {
  contract_io::GreyImage image;
  image.rows = rows;
  image.cols = cols;
  for (int i = 0; i < rows * cols; ++i) image.pixels8.push_back(static_cast<std::uint8_t>(i * 7));
  return image;
}

inline const char* const kCaptureJson = R"({
  "format": "beltpick-capture", "version": 1, "full_scale": 255,
  "projector": {"width": 912, "height": 1140, "layout": "square"},
  "frames": [
    {"file": "000.png", "kind": "phase", "axis": "column", "period_px": 18, "steps": 8, "step": 0, "offset_rad": 0.5,
     "exposure_us": 8000},
    {"file": "001.png", "kind": "gray", "axis": "row", "cell_px": 9, "bit": 6, "inverted": true},
    {"file": "002.png", "kind": "white"},
    {"file": "003.png", "kind": "black"}]})";

inline const char* const kCalibrationJson = R"({
  "format": "beltpick-calibration", "version": 1, "id": "c1", "camera_serial": "A7",
  "camera": {"width": 1280, "height": 960, "matrix": [[2000, 0, 640], [0, 2001, 480], [0, 0, 1]],
             "distortion": [0.1, -0.2, 0.001, 0.002, 0.03]},
  "projector": {"width": 912, "height": 1140, "matrix": [[1500, 0, 456], [0, 1500, 570], [0, 0, 1]],
                "distortion": [0, 0, 0, 0, 0]},
  "projector_from_camera": {"rotation": [[0.8660254, 0, 0.5], [0, 1, 0], [-0.5, 0, 0.8660254]],
                            "translation": [-350, 0, 90]},
  "quality": {"rms_px": 0.3}})";

inline const char* const kCellJson = R"({
  "format": "beltpick-cell", "version": 1, "calibration_id": "c1",
  "belt_from_camera": [[1, 0, 0, 10], [0, -1, 0, 20], [0, 0, -1, 700], [0, 0, 0, 1]],
  "robot_from_camera": [[0, 1, 0, 1], [1, 0, 0, 2], [0, 0, -1, 3], [0, 0, 0, 1]]})";

}  // namespace beltpick::test
