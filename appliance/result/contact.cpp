#include "result/contact.hpp"

#include <cmath>

namespace beltpick::result {

namespace {

constexpr float kRounding_mm = 1e-2F;  // a box and the points in it are rounded each by itself

bool reaches(const Rival& from, const Rival& to, double reach_mm) {
  const auto T_to_from = to.T_camera_part.inverse() * from.T_camera_part;
  // Points between two of those looked at lie nearer by up to half their distance.
  const auto stride = static_cast<std::size_t>(std::fmax(1.0, std::floor(1.0F / from.model.spacing_mm)));
  const auto reach = static_cast<float>(reach_mm + 0.5 * static_cast<double>(from.model.spacing_mm));
  for (std::size_t i = 0; i < from.model.surface.size(); i += stride) {
    const Vec3 place = from.model.surface[i].point_mm.cast<double>();
    const Vec3f at = (T_to_from.rotation * place + T_to_from.translation_mm).cast<float>();
    if (to.model.outside_box_mm(at) > reach + kRounding_mm) continue;
    if ((to.model.nearest(at).point_mm - at).squaredNorm() < reach * reach) return true;
  }
  return false;
}

}  // namespace

bool in_contact(const Rival& a, const Rival& b, double reach_mm) {
  const double apart_mm = (a.T_camera_part * a.model.centre_mm - b.T_camera_part * b.model.centre_mm).norm();
  if (apart_mm > 0.5 * (a.model.diagonal_mm + b.model.diagonal_mm) + reach_mm) return false;
  return reaches(a, b, reach_mm) || reaches(b, a, reach_mm);
}

}  // namespace beltpick::result
