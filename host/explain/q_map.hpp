// QMap: Q(P, M), the paper's equation (6), over the poses that a search tried: the paper's figure 7.
#pragma once

#include <string>
#include <vector>

#include "contract/part_model.hpp"
#include "explain/story.hpp"
#include "search/hypothesis_pool.hpp"

namespace beltpick::explain {

// Q over two of the freedoms searched, the best over all others.
struct QPanel {
  struct Cell {
    double x = 0.0, y = 0.0;
    double mean_distance_mm = 0.0;
  };
  std::string title;
  std::string x_label, y_label;       // with units
  double x_step = 1.0, y_step = 1.0;  // from cell to cell
  bool scattered = false;             // cells lie where they lie, on no lattice
  std::vector<Cell> cells;
};

// The poses that one matched primitive, or the views of a part, left to try.
struct QMap {
  int model_index = 0;
  std::string about;  // what was matched, in words
  int tried = 0;      // poses
  double best_mm = 0.0;
  std::vector<QPanel> panels;  // a cylinder's: one a flip, shift along the axis x turn about it
};

// What the search evaluated, with every Q to its end: one map a primitive found and a taught one that matches it, or a
// single one for the views of each model. The best first.
std::vector<QMap> q_maps(const SearchStory& search, std::span<const PartModel> models);

}  // namespace beltpick::explain
