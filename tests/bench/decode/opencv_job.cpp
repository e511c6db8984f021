#include "bench/decode/opencv_job.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/units.hpp"

namespace beltpick::bench {
namespace {

const FrameSpec& spec_of(const Loaded& loaded, std::size_t frame) { return loaded.header.sequence.frames[frame]; }

cv::Mat image_of(const Loaded& loaded, std::size_t frame) {
  // OpenCV wants a pointer to mutable pixels, and only reads them.
  return {loaded.rows(), loaded.cols(), CV_8U, const_cast<std::uint8_t*>(loaded.frames[frame].pixels8.data())};
}

// What does not depend on the capture.
struct Table {
  cv::Mat u, v, ray_length;                 // of the camera's rays, at z = 1
  cv::Mat q_s, q_z, across, offset, slope;  // see range/axis_kernel.hpp
};

Table make_table(const Calibration& calibration) {
  const Lens& camera = calibration.camera;
  std::vector<cv::Point2f> pixels;
  for (int r = 0; r < camera.height; ++r) {
    for (int c = 0; c < camera.width; ++c) pixels.emplace_back(static_cast<float>(c), static_cast<float>(r));
  }
  const cv::Matx33d matrix(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  std::vector<cv::Point2f> ideal;
  cv::undistortPoints(pixels, ideal, matrix, std::vector<double>(camera.distortion.begin(), camera.distortion.end()),
                      cv::noArray(), cv::noArray(), cv::TermCriteria(cv::TermCriteria::COUNT, 20, 0.0));
  const cv::Mat rays = cv::Mat(ideal, true).reshape(2, camera.height);
  Table table;
  cv::extractChannel(rays, table.u, 0);
  cv::extractChannel(rays, table.v, 1);
  const auto& pose = calibration.T_projector_camera;
  const auto form = [&](const Vec3& f) { return cv::Mat(f.x() * table.u + f.y() * table.v + f.z()); };
  const Vec3 q_s = pose.rotation.row(0);
  const Vec3 q_o = pose.rotation.row(1);
  const Vec3 q_z = pose.rotation.row(2);
  const Vec3& t = pose.translation_mm;
  table.q_s = form(q_s);
  table.q_z = form(q_z);
  table.across = form(t.z() * q_s - t.x() * q_z);
  table.offset = form(t.y() * q_s - t.x() * q_o) / table.across;
  table.slope = form(t.z() * q_o - t.y() * q_z) / table.across;
  cv::sqrt(table.u.mul(table.u) + table.v.mul(table.v) + 1.0, table.ray_length);
  return table;
}

struct Result {
  cv::Mat code_px, points_mm, sigma_mm;
};

class OpencvJob {
 public:
  OpencvJob(const Loaded& loaded, const Calibration& calibration, const decode::FoldPlan& plan)
      : loaded_(loaded), calibration_(calibration), plan_(plan), table_(make_table(calibration)) {}

  Result run() {
    add_fringes();
    read_cells();
    Result result;
    order_fringes(result.code_px);
    triangulate(result);
    return result;
  }

 private:
  void add_fringes() {
    cosine_ = cv::Mat::zeros(loaded_.rows(), loaded_.cols(), CV_32F);
    sine_ = cosine_.clone();
    most_ = cv::Mat::zeros(loaded_.rows(), loaded_.cols(), CV_8U);
    for (std::size_t f = 0; f < loaded_.frames.size(); ++f) {
      if (spec_of(loaded_, f).kind != FrameKind::kPhase) continue;
      const decode::Accumulate& weights = plan_.frames[f].accumulate;
      const cv::Mat image = image_of(loaded_, f);
      cv::max(most_, image, most_);
      image.convertTo(level_, CV_32F);
      cv::scaleAdd(level_, weights.cosine_weight, cosine_, cosine_);
      cv::scaleAdd(level_, weights.sine_weight, sine_, sine_);
    }
    cv::phase(cosine_, sine_, phase_);
    cv::magnitude(cosine_, sine_, amplitude_);
  }

  void read_cells() {
    for (std::size_t f = 0; f < loaded_.frames.size(); ++f) {
      if (spec_of(loaded_, f).kind == FrameKind::kWhite) white_ = image_of(loaded_, f);
      if (spec_of(loaded_, f).kind == FrameKind::kBlack) black_ = image_of(loaded_, f);
    }
    cv::addWeighted(white_, 0.5, black_, 0.5, 0.0, middle_);
    cv::Mat above = cv::Mat::zeros(loaded_.rows(), loaded_.cols(), CV_8U);
    cv::Mat cell = above.clone();
    const decode::GrayCode& code = plan_.grays.front();
    for (std::size_t b = code.bits.size(); b-- > 0;) {
      cv::compare(image_of(loaded_, static_cast<std::size_t>(code.bits[b].frame)), middle_, bright_, cv::CMP_GT);
      cv::bitwise_xor(above, bright_, above);
      cv::bitwise_and(above, cv::Scalar(static_cast<double>(1U << b)), bright_);
      cv::bitwise_or(cell, bright_, cell);
    }
    cell.convertTo(centre_px_, CV_32F, code.cell_px, 0.5 * code.cell_px - 0.5);
  }

  void order_fringes(cv::Mat& code_px) {
    const decode::PhaseChannel& fringes = plan_.channels.front();
    const double period_px = fringes.period_px;
    cv::Mat orders;
    cv::scaleAdd(phase_, -period_px / (2.0 * kPi), centre_px_, code_px);
    code_px.convertTo(orders, CV_32S, 1.0 / period_px);
    orders.convertTo(code_px, CV_32F, period_px);
    cv::scaleAdd(phase_, period_px / (2.0 * kPi), code_px, code_px);
    // Weak or saturated: not measured.
    constexpr double kLeastSigmas = 6.4;
    cv::add(white_, black_, level_, cv::noArray(), CV_32F);
    level_.convertTo(variance_, CV_32F, 0.5 * 0.0255, 0.64);
    cv::multiply(amplitude_, amplitude_, amplitude_squared_);
    const double factor = std::pow(kLeastSigmas * fringes.noise_gain, 2);
    cv::compare(amplitude_squared_, factor * variance_, bright_, cv::CMP_LT);
    code_px.setTo(NAN, bright_);
    cv::compare(most_, 255, bright_, cv::CMP_EQ);
    code_px.setTo(NAN, bright_);
  }

  // Newton's method for the projector's lens as whole images: a corrected start, then one step.
  void triangulate(Result& result) {
    const Lens& lens = calibration_.projector;
    const auto& [k1, k2, p1, p2, k3] = lens.distortion;
    const auto& t = calibration_.T_projector_camera.translation_mm;
    cv::Mat seen, o, r2, radial, bend, work, gradient, miss, s;
    result.code_px.convertTo(seen, CV_32F, 1.0 / lens.fx_px, -lens.cx_px / lens.fx_px);
    seen.copyTo(s);
    for (int step = 0; step < 2; ++step) {
      cv::multiply(table_.slope, s, o);
      cv::add(o, table_.offset, o);
      const cv::Mat ss = s.mul(s);
      const cv::Mat so = s.mul(o);
      cv::multiply(o, o, r2);
      cv::add(r2, ss, r2);
      r2.convertTo(radial, CV_32F, k3, k2);
      cv::multiply(radial, r2, radial);
      cv::add(radial, k1, radial);
      cv::multiply(radial, r2, radial);
      cv::add(radial, 1.0, radial);
      cv::multiply(s, radial, miss);
      cv::subtract(miss, seen, miss);
      cv::scaleAdd(so, 2.0 * p1, miss, miss);
      cv::scaleAdd(r2, p2, miss, miss);
      cv::scaleAdd(ss, 2.0 * p2, miss, miss);
      r2.convertTo(bend, CV_32F, 6.0 * k3, 4.0 * k2);
      cv::multiply(bend, r2, bend);
      cv::add(bend, 2.0 * k1, bend);
      cv::multiply(ss, bend, gradient);
      cv::add(gradient, radial, gradient);
      cv::scaleAdd(o, 2.0 * p1, gradient, gradient);
      cv::scaleAdd(s, 6.0 * p2, gradient, gradient);
      cv::multiply(so, bend, work);
      cv::scaleAdd(s, 2.0 * p1, work, work);
      cv::scaleAdd(o, 2.0 * p2, work, work);
      cv::multiply(work, table_.slope, work);
      cv::add(gradient, work, gradient);
      cv::divide(miss, gradient, miss);
      cv::subtract(s, miss, s);
    }
    cv::Mat denominator, z, x, y, mm_per_px;
    cv::multiply(s, table_.q_z, denominator);
    cv::subtract(denominator, table_.q_s, denominator);
    s.convertTo(z, CV_32F, -t.z(), t.x());
    cv::divide(z, denominator, z);
    cv::multiply(denominator, denominator, mm_per_px);
    cv::multiply(mm_per_px, gradient, mm_per_px, lens.fx_px);
    cv::divide(table_.across, mm_per_px, mm_per_px);
    const double slope_px = plan_.channels.front().noise_gain * plan_.channels.front().period_px / (2.0 * kPi);
    white_.convertTo(variance_, CV_32F, 0.5 * 0.0255, 0.64);
    cv::divide(variance_, amplitude_squared_, variance_, slope_px * slope_px);
    cv::sqrt(variance_, result.sigma_mm);
    cv::multiply(result.sigma_mm, cv::abs(mm_per_px), result.sigma_mm);
    cv::multiply(result.sigma_mm, table_.ray_length, result.sigma_mm);
    cv::patchNaNs(z, 0.0);
    cv::multiply(table_.u, z, x);
    cv::multiply(table_.v, z, y);
    cv::merge(std::vector<cv::Mat>{x, y, z}, result.points_mm);
  }

  const Loaded& loaded_;
  const Calibration& calibration_;
  const decode::FoldPlan& plan_;
  Table table_;
  cv::Mat cosine_, sine_, most_, level_, phase_, amplitude_, amplitude_squared_, variance_, white_, black_, middle_,
      bright_, centre_px_;
};

double nearly_worst(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.9999 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void compare(const Result& result, const Job& reference, OpencvTimes& times) {
  std::vector<double> code_px, depth_mm;
  double measured = 0.0;
  const RangeImage& range = reference.range();
  for (int r = 0; r < range.point_mm.rows; ++r) {
    for (int c = 0; c < range.point_mm.cols; ++c) {
      if (!range.valid(r, c)) continue;
      measured += 1.0;
      const float z = result.points_mm.at<cv::Vec3f>(r, c)[2];
      if (z == 0.0F) continue;
      code_px.push_back(std::fabs(result.code_px.at<float>(r, c) - reference.code().column_px(r, c)));
      depth_mm.push_back(std::fabs(z - range.point_mm(r, c).z()));
    }
  }
  times.share_both = static_cast<double>(depth_mm.size()) / std::max(measured, 1.0);
  times.worst_code_px = nearly_worst(code_px);
  times.worst_depth_mm = nearly_worst(depth_mm);
}

}  // namespace

OpencvTimes time_opencv(const Loaded& loaded, const Calibration& calibration, const Job& reference, int passes) {
  cv::setNumThreads(1);
  OpencvJob job(loaded, calibration, reference.plan());
  std::vector<double> all_ms;
  Result result;
  for (int pass = 0; pass < passes; ++pass) {
    const double start_ms = thread_ms();
    result = job.run();
    all_ms.push_back(thread_ms() - start_ms);
  }
  OpencvTimes times{.ms = median(all_ms)};
  compare(result, reference, times);
  return times;
}

}  // namespace beltpick::bench
