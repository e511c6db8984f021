#include "projector/drm_projector.hpp"

#include <algorithm>
#include <cstdio>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"

namespace beltpick::projector {

namespace {

void draw(const FrameSpec& frame, const ProjectorGrid& grid, DrmPage& page) {
  for (int row = 0; row < grid.height; ++row) {
    std::uint32_t* pixels = page.pixels + static_cast<std::size_t>(row) * page.stride_px;
    for (int column = 0; column < grid.width; ++column) {
      const double x = lattice_coordinate(grid.layout, frame.axis, row, column);
      const auto level = static_cast<std::uint32_t>(255.0 * pattern_intensity(frame, x) + 0.5);
      pixels[column] = level << 16U | level << 8U | level;
    }
  }
}

}  // namespace

Result<void> DrmProjector::prepare(const ShowPlan& plan) {
  const ProjectorGrid& grid = plan.sequence.projector;
  display_.close();
  const auto frames = static_cast<int>(plan.sequence.frames.size());
  Result<void> done = display_.open({config_.device, config_.connector, grid.width, grid.height});
  if (done) done = display_.make_pages(frames + 1);
  if (!done) return done;
  for (int i = 0; i < frames; ++i) draw(plan.sequence.frames[static_cast<std::size_t>(i)], grid, display_.page(i));
  DrmPage& dark = display_.page(dark_page());
  std::fill_n(dark.pixels, dark.bytes / sizeof *dark.pixels, 0U);
  return display_.set_mode(dark_page());
}

Result<void> DrmProjector::start() {
  const auto shown = show(dark_page());
  return shown ? Result<void>() : std::unexpected(shown.error());
}

Result<void> DrmProjector::stop() { return display_.is_open() ? start() : Result<void>(); }

Result<void> DrmProjector::check() {
  if (display_.is_open()) return display_.check();
  return failure(ResultCode::kProjectorLost, "projector: not open; it is looked for again by itself");
}

Result<std::int64_t> DrmProjector::show(int frame) {
  if (display_.is_open()) return display_.flip(frame);
  return failure(ResultCode::kProjectorLost, "projector: not open; it is looked for again by itself");
}

ProjectorFacts DrmProjector::facts() const {
  if (!display_.is_open()) return {"display", config_.device, "", config_.connector};
  char memory[64];
  std::snprintf(memory, sizeof memory, ", %d pages of %.1f MB", display_.pages(),
                static_cast<double>(display_.page_bytes()) / 1e6);
  return {"display", display_.name(), "", display_.mode_text() + memory};
}

}  // namespace beltpick::projector
