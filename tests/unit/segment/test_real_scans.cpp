#include <catch2/catch.hpp>
#include <map>

#include "contract_io/cloud_io.hpp"
#include "contract_io/npy_io.hpp"
#include "support/real_data.hpp"
#include "support/segmenting.hpp"

using namespace beltpick;

namespace {

// The best intersection over union of each hand-labelled object of 500 pixels or more with any segment.
std::vector<double> best_overlaps(ImageView<const std::uint16_t> labels, const std::vector<std::uint8_t>& by_hand) {
  std::map<int, std::map<int, int>> common;
  std::map<int, int> object_px;
  std::map<int, int> segment_px;
  for (std::size_t p = 0; p < labels.size(); ++p) {
    const int object = by_hand[p] >= 20 ? by_hand[p] / 10 : 0;
    ++object_px[object];
    ++segment_px[labels.data[p]];
    ++common[object][labels.data[p]];
  }
  std::vector<double> overlaps;
  for (const auto& [object, pixels] : object_px) {
    if (object == 0 || pixels < 500) continue;
    double best = 0.0;
    for (const auto& [segment, both] : common[object]) {
      if (segment != 0) best = std::max(best, both / static_cast<double>(pixels + segment_px[segment] - both));
    }
    overlaps.push_back(best);
  }
  return overlaps;
}

}  // namespace

TEST_CASE("objects on a table in real scans are found as people mark them", "[segment][real]") {
  const auto folder = test::real_data("range-scans");
  if (folder.empty()) return;
  Limits limits;
  limits.image_width = 640;
  limits.image_height = 480;
  test::SegmenterWithMemory segmenter(limits);
  double sum = 0.0;
  int objects = 0;
  for (const char* scan : {"learn33", "learn34", "learn35", "learn36"}) {
    contract_io::Warnings warnings;
    auto cloud = contract_io::read_cloud(folder / (std::string(scan) + "_xyz.npy"), warnings);
    REQUIRE(cloud.has_value());
    const auto by_hand = contract_io::read_npy<std::uint8_t>(folder / (std::string(scan) + "_labels.npy"), {480, 640});
    REQUIRE(by_hand.has_value());
    const auto found = segmenter->segment(cloud->view(), {.cut_creases = true, .join_fragments = true});
    REQUIRE(found.belt.has_value());
    for (const double overlap : best_overlaps(found.labels, by_hand->values)) {
      INFO(scan << " " << overlap << ", segments: " << found.segments.size());
      CHECK(overlap > 0.5);
      sum += overlap;
      ++objects;
    }
  }
  REQUIRE(objects > 0);
  INFO("mean overlap " << sum / objects);
  CHECK(sum / objects >= 0.88);
  WARN("mean overlap " << sum / objects << " of " << objects << " objects");
}
