// Plate: the calibration plate of the virtual cell: printed, of some thickness, and bent as real plates are.
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.hpp"
#include "virtual_cell/render/board_print.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

struct PlateOptions {
  Board board;
  double quiet_zone_mm = 10.0;  // white border round the print
  double thickness_mm = 5.0;
  double bend_mm = 0.05;  // from the highest to the lowest place of the printed face
};

// The plate's frame is the print's (see BoardPrint), z into the plate: seen from the front x runs right and y down.
class Plate {
 public:
  // `seed` fixes how the plate is bent: one physical plate a seed. Errors: as BoardPrint::make, and kValueOutOfRange
  // for a quiet zone, thickness or bend that no plate has.
  static Result<Plate> make(const PlateOptions& options, std::uint64_t seed);

  [[nodiscard]] const PlateOptions& options() const { return options_; }
  // z of the printed face at a place of the plate.
  [[nodiscard]] double bow_mm(double x_mm, double y_mm) const;
  // The inner corners on the bent face, row by row.
  [[nodiscard]] std::vector<Vec3> corners_mm() const;
  // The outline of the printed face, `inset_mm` within the plate's border: `steps` points a side, clockwise.
  [[nodiscard]] std::vector<Vec3> outline_mm(double inset_mm, int steps) const;
  // The middle of the printed face.
  [[nodiscard]] Vec3 centre_mm() const;
  // The plate as something to render, named "plate".
  [[nodiscard]] Result<ScenePart> part() const;

 private:
  Plate(const PlateOptions& options, BoardPrint print) : options_(options), print_(std::move(print)) {}
  // The bend before it is scaled, at a place relative to the middle.
  [[nodiscard]] double bend_shape(double u_mm, double v_mm) const;

  PlateOptions options_;
  BoardPrint print_;
  double dome_ = 0.0, saddle_ = 0.0, twist_ = 0.0;  // of a quadratic surface
  double mean_ = 0.0, scale_ = 0.0;
};

}  // namespace beltpick::virtual_cell
