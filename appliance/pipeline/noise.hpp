// How noisy the measured points are.
#pragma once

#include <cstdint>

#include "base/stages.hpp"

namespace beltpick::pipeline {

// The typical standard deviation of a point on an object, mm: the median of what triangulation predicts, or, for a
// foreign cloud that predicts nothing, from the second differences along its rows. At least 0.02.
double measurement_noise_mm(const RangeImage& range, ImageView<const std::uint16_t> labels);

}  // namespace beltpick::pipeline
