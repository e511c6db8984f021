// One search on the page: what its stages found, with pictures.
#pragma once

#include <string>
#include <vector>

#include "explain/crop.hpp"
#include "explain/explain.hpp"
#include "html/page.hpp"

namespace beltpick::explain {

// Pictures that the page refers to: kept until the page is written.
class Album {
 public:
  // HTML of the picture, shown at `width_px` at least where it is smaller.
  std::string add(const std::string& name, Picture picture);
  [[nodiscard]] Result<void> write(const std::filesystem::path& folder) const;

 private:
  std::vector<std::pair<std::string, Picture>> pictures_;
};

// The stages of one search: primitives, Q maps, hypotheses, and those of the pose judged: alignment, verification,
// rivals. `judged` null: the first one judged. `prefix` begins the names of its pictures.
std::string search_section(const SearchStory& search, const Judged* judged, const Frame& frame,
                           const Explained& explained, const std::string& prefix, Album& album);

}  // namespace beltpick::explain
