#include "bench/decode/opencv_gray.hpp"

#include <cmath>
#include <opencv2/structured_light.hpp>

namespace beltpick::bench {

GrayTimes time_opencv_gray(const Loaded& loaded, const Job& reference, int passes) {
  cv::setNumThreads(1);
  std::vector<cv::Mat> images;
  for (std::size_t f = 0; f < loaded.frames.size(); ++f) {
    if (loaded.header.sequence.frames[f].kind != FrameKind::kGray) continue;
    images.emplace_back(loaded.rows(), loaded.cols(), CV_8U,
                        const_cast<std::uint8_t*>(loaded.frames[f].pixels8.data()));  // only read
  }
  const ProjectorGrid& projector = loaded.header.sequence.projector;
  const auto pattern = cv::structured_light::GrayCodePattern::create(projector.width, projector.height);
  std::vector<double> all_ms;
  std::vector<cv::Point> found(static_cast<std::size_t>(loaded.rows()) * static_cast<std::size_t>(loaded.cols()));
  for (int pass = 0; pass < passes; ++pass) {
    const double start_ms = thread_ms();
    for (int r = 0; r < loaded.rows(); ++r) {
      for (int c = 0; c < loaded.cols(); ++c) {
        cv::Point& at = found[static_cast<std::size_t>(r * loaded.cols() + c)];
        if (pattern->getProjPixel(images, c, r, at)) at = {-1, -1};
      }
    }
    all_ms.push_back(thread_ms() - start_ms);
  }
  GrayTimes times{.opencv_ms = median(all_ms)};
  const CodeImage& code = reference.code();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const float column_px = code.column_px.data[i];
    const float row_px = code.row_px.data[i];
    if (found[i].x < 0 || std::isnan(column_px) || std::isnan(row_px)) continue;
    ++times.compared;
    const bool same = std::fabs(column_px - static_cast<float>(found[i].x)) <= 0.51F &&
                      std::fabs(row_px - static_cast<float>(found[i].y)) <= 0.51F;
    times.different += same ? 0 : 1;
  }
  return times;
}

}  // namespace beltpick::bench
