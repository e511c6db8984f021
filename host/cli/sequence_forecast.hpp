// What a pattern sequence costs and gives before anything is captured: frames, time, the decoder's memory, and the
// noise that the noise law predicts for a rig. Behind `beltpick patterns --explain`.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::cli {

// How frames follow each other: as fast as the projector shows them, or as long as the camera exposes.
struct FrameTiming {
  double projector_hz = 60.0;
  double exposure_us = 8000.0;

  [[nodiscard]] double frame_us() const { return std::max(exposure_us, 1e6 / projector_hz); }
};

// Where noise is predicted: on the ray through the middle of the camera's image.
struct WorkingPoint {
  Calibration calibration;
  double distance_mm = 0.0;
  Vec3 ray = Vec3::UnitZ();  // direction of that ray, z = 1, camera frame
};

// The default rig (see the design) with this projector, at the belt. Error: kValueOutOfRange.
Result<WorkingPoint> default_working_point(const ProjectorGrid& projector);
// With a calibration, where that ray comes nearest to the middle of the projector's light, unless `distance_mm` > 0
// tells where. Error: kValueOutOfRange where that lies nowhere in front of both.
Result<WorkingPoint> working_point(const Calibration& calibration, double distance_mm);

struct AxisForecast {
  Axis axis = Axis::kColumn;
  CodeNoise noise;
  double mm_per_px = 0.0;  // depth for a projector pixel

  // Predicted standard deviation of the depth where the fringes' amplitude is `modulation` grey levels of 255 and their
  // mean a tenth more, as for matt surfaces in weak ambient light.
  [[nodiscard]] double sigma_mm(double modulation) const;
};

struct SequenceForecast {
  int frames = 0;
  double time_ms = 0.0;
  int state_bytes8 = 0, state_bytes16 = 0;  // of the decoder, a pixel, for 8- and 16-bit cameras
  double distance_mm = 0.0;
  std::vector<AxisForecast> axes;
};

// `load_us`: what a projector needs besides to load images. Error: kSequenceUndecodable.
Result<SequenceForecast> forecast(const Sequence& sequence, const FrameTiming& timing, double load_us,
                                  const WorkingPoint& at);

std::string forecast_text(const SequenceForecast& forecast, const FrameTiming& timing);
contract_io::Json forecast_json(const SequenceForecast& forecast, const FrameTiming& timing);

}  // namespace beltpick::cli
