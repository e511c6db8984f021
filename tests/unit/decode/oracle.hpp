// A slow and obvious decoder: one pixel at a time, double precision, straight from the format's words.
#pragma once

#include <optional>

#include "contract/capture.hpp"
#include "unit/decode/synthetic.hpp"

namespace beltpick::testing {

// The coordinate along `axis` at pixel `i`; no judgement of its quality. Knows captures of one exposure.
double oracle_coordinate(const Sequence& sequence, const Images& images, Axis axis, std::size_t i);

// Amplitude of the finest fringe of `axis` in levels.
double oracle_amplitude(const Sequence& sequence, const Images& images, Axis axis, std::size_t i);

}  // namespace beltpick::testing
