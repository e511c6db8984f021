// Pictures of results for a person to look at: range image in colour, objects in colour, found parts over the camera's
// image. Shared by the command line and the appliance's recorder.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.hpp"
#include "base/pose.hpp"
#include "contract/calibration.hpp"
#include "contract/locate_result.hpp"
#include "contract/part_template.hpp"
#include "contract_io/image_io.hpp"

namespace beltpick::contract_io {

// An RGB picture that owns its pixels.
struct Picture {
  int rows = 0, cols = 0;
  std::vector<Rgb> pixels;

  Picture() = default;
  Picture(int rows_, int cols_) : rows(rows_), cols(cols_), pixels(static_cast<std::size_t>(rows_) * cols_) {}
  [[nodiscard]] ImageView<Rgb> view() { return {pixels.data(), rows, cols}; }
  [[nodiscard]] ImageView<const Rgb> view() const { return {pixels.data(), rows, cols}; }
};

// The colour of object `number` (1..): neighbours in number differ strongly, and the colours repeat after many.
Rgb object_colour(unsigned number);

// Camera z in colour from red (near) to blue (far), stretched over the middle 98 % of what is there; 0 is black.
Picture range_picture(ImageView<const float> z_mm);

// Every object's pixels in its colour, shaded by the texture; what is no object stays grey. `texture` may be empty.
Picture labels_picture(ImageView<const std::uint16_t> labels, ImageView<const std::uint8_t> texture);

// Every found part as its template appears in the found pose: its surface tinted, its outline drawn in full colour; an
// ambiguous pose's outline is dotted. `templates` are those that LocatedPart::template_index counts in.
Picture overlay_picture(ImageView<const std::uint8_t> texture, std::span<const LocatedPart> parts,
                        std::span<const PartTemplate> templates, const Lens& camera);

}  // namespace beltpick::contract_io
