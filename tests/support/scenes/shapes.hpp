// Test parts as signed distance functions, and templates sampled from them: shares no code with teaching.
#pragma once

#include <functional>
#include <string>

#include "contract/part_template.hpp"

namespace beltpick::test {

// Distance to the surface, negative inside; exact or an underestimate away from it.
using Distance = std::function<double(const Vec3&)>;

struct Shape {
  std::string name;
  Distance distance;
  Vec3 box_min_mm, box_max_mm;
  std::vector<Primitive> primitives;
  Symmetry symmetry;
};

Shape bracket();           // an L of two plates with a boss on one: no symmetry, chiral
Shape mirrored(Shape of);  // as seen in a mirror (x -> -x); without primitives
Shape knuckle();           // a cast lever: hub with a bore, arm, lug: about 150 x 80 mm
Shape block();             // 80 x 50 x 30 mm: D2
Shape pin();               // a cylinder of 12 mm radius and 90 mm length: revolution with a flip
Shape flange();            // a disc with a hub, four holes: C4
Shape plate();             // 200 x 140 x 12 mm: larger than the others, foreign
Shape sheet();             // an angular sheet of 3 mm: thin, chiral

// About `points` surface points, evenly spread, with normals by the distance's gradient.
PartTemplate template_of(const Shape& shape, std::size_t points = 12000);

// Outward unit normal.
Vec3 gradient(const Distance& distance, const Vec3& at);

}  // namespace beltpick::test
