// Freedoms: what a pose's covariance and the part's symmetry say, in words: how firmly each motion of the part is held,
// and which cannot be observed at all.
#pragma once

#include <string>
#include <vector>

#include "contract/locate_result.hpp"
#include "contract/part_template.hpp"

namespace beltpick {

// One of six motions of a part that vary independently of each other.
struct Freedom {
  bool turn = false;                    // else a slide
  Vec3 direction_part = Vec3::UnitZ();  // of the axis, or of the slide
  Vec3 through_part_mm = Vec3::Zero();  // a point of a turn's axis
  double sigma = 0.0;                   // rad for a turn, mm for a slide: by random errors alone
  double rim_mm = 0.0;                  // what that moves the part's rim (half its diagonal from the centre) by
  bool observable = true;
  bool by_symmetry = false;  // not observable because the part looks the same
  std::string words;         // "turn about the part's axis of symmetry"
};

// The freedoms of a located part, the least firmly held first. `covariance` as in LocatedPart: a small motion in the
// camera frame about the centre of the part's box. A turn counts as not observable from 0.1 degree on, a slide from
// 0.1 mm: with what errs the same way at many points that is ten times as much.
std::vector<Freedom> freedoms_of(const Eigen::Matrix<double, 6, 6>& covariance,
                                 const Pose<frame::Camera, frame::Part>& T_camera_part, const PartTemplate& part);

// What a capture cannot tell of the pose, in words: freedoms that are not observable, and of which poses that look the
// same it may be another. Empty where the pose is unique.
std::vector<std::string> unobservable(const std::vector<Freedom>& freedoms, const Symmetry& symmetry);

// The covariance with turns that a symmetry leaves free as uncertain as they are: evenly spread over a whole turn.
// `axis_point_mm`, `axis_direction` in the camera frame, `centre_mm` that of the part's box.
void add_free_turn(Eigen::Matrix<double, 6, 6>& covariance, const Vec3& axis_point_mm, const Vec3& axis_direction,
                   const Vec3& centre_mm);

}  // namespace beltpick
