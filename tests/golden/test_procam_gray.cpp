// The real captures of procam-gray against OpenCV's own decoder: GrayCodePattern with white threshold 5, black 40.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/structured_light.hpp>
#include <vector>

#include "contract_io/npy_io.hpp"
#include "support/run_program.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::test {
namespace {

std::filesystem::path procam_folder() {
  const char* environment = std::getenv("BELTPICK_REAL_DATA");
  const std::filesystem::path data =
      environment != nullptr ? environment : std::filesystem::path(BELTPICK_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "procam-gray";
}

class OpenCvDecoder {
 public:
  explicit OpenCvDecoder(const std::filesystem::path& capture) {
    pattern_->setWhiteThreshold(5);
    for (int i = 0; i < 42; ++i) {
      char name[32];
      std::snprintf(name, sizeof name, "graycode_%02d.png", i);
      frames_.push_back(cv::imread((capture / name).string(), cv::IMREAD_GRAYSCALE));
    }
    black_ = frames_.back();
    frames_.pop_back();
    white_ = frames_.back();
    frames_.pop_back();
  }

  [[nodiscard]] bool pixel(int row, int col, cv::Point& projector) const {
    constexpr int kBlackThreshold = 40;
    if (white_.at<std::uint8_t>(row, col) - black_.at<std::uint8_t>(row, col) <= kBlackThreshold) return false;
    return !pattern_->getProjPixel(frames_, col, row, projector);
  }
  [[nodiscard]] cv::Size size() const { return white_.size(); }

 private:
  cv::Ptr<cv::structured_light::GrayCodePattern> pattern_ = cv::structured_light::GrayCodePattern::create(1024, 768);
  std::vector<cv::Mat> frames_;
  cv::Mat white_, black_;
};

TEST_CASE("real captures decode as OpenCV decodes them") {
  if (!std::filesystem::exists(procam_folder())) {
    WARN("no real data at " << procam_folder() << ": skipped");
    return;
  }
  const TempFolder temp;
  for (int capture = 0; capture < 5; ++capture) {
    const auto folder = procam_folder() / ("capture_" + std::to_string(capture));
    const auto written = temp.path() / "code.npy";
    REQUIRE(beltpick_run("decode " + folder.string() + " --code " + written.string()).exit_code == 0);
    const auto code = contract_io::read_npy<float>(written, {-1, -1, 2});
    REQUIRE(code);
    const OpenCvDecoder oracle(folder);
    REQUIRE(oracle.size() == cv::Size(code->shape[1], code->shape[0]));
    int valid = 0;
    int covered = 0;
    int within = 0;
    std::vector<float> off;
    for (int r = 0; r < code->shape[0]; ++r) {
      for (int c = 0; c < code->shape[1]; ++c) {
        cv::Point projector;
        if (!oracle.pixel(r, c, projector)) continue;
        ++valid;
        const std::size_t at =
            2 * (static_cast<std::size_t>(r) * static_cast<std::size_t>(code->shape[1]) + static_cast<std::size_t>(c));
        const float distance = std::max(std::abs(code->values[at] - static_cast<float>(projector.x)),
                                        std::abs(code->values[at + 1] - static_cast<float>(projector.y)));
        if (std::isnan(code->values[at]) || std::isnan(code->values[at + 1])) continue;
        ++covered;
        within += distance <= 1.0F ? 1 : 0;
        off.push_back(distance);
      }
    }
    INFO("capture_" << capture << ": OpenCV calls " << valid << " valid; of these " << covered << " covered, " << within
                    << " within a pixel");
    REQUIRE(valid > 100'000);
    CHECK(covered >= 0.98 * valid);
    CHECK(within >= 0.995 * valid);
    std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2), off.end());
    CHECK(off[off.size() / 2] <= 0.25F);
  }
}

}  // namespace
}  // namespace beltpick::test
