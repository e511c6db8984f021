#include "pattern_images.hpp"

#include <array>
#include <cstdio>

#include "contract/sequences.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/pictures.hpp"
#include "progress.hpp"

namespace beltpick::cli {

namespace {

using lcr4500::kPlanesPerImage;

constexpr int kBitsPerColour = 8;
constexpr std::array<char, 3> kPlaneColours{'G', 'R', 'B'};
constexpr std::array<std::size_t, 3> kRgbIndex{1, 0, 2};  // of the plane colours

void add_planes(const std::vector<std::uint8_t>& levels, const FlashPlace& place, contract_io::Picture& image) {
  for (int bit = 0; bit < place.bits; ++bit) {
    const int plane = place.first_plane + bit;
    const std::size_t channel = kRgbIndex[static_cast<std::size_t>(plane / kBitsPerColour)];
    const int to = plane % kBitsPerColour;
    const int from = place.bits == 1 ? kBitsPerColour - 1 : bit;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const auto value = static_cast<unsigned>(levels[i] >> from) & 1U;
      image.pixels[i][channel] = static_cast<std::uint8_t>(image.pixels[i][channel] | value << to);
    }
  }
}

std::string plane_name(int plane) {
  return kPlaneColours[static_cast<std::size_t>(plane / kBitsPerColour)] + std::to_string(plane % kBitsPerColour);
}

std::string image_line(const Sequence& sequence, const lcr4500::FlashPlan& plan, int image) {
  int planes = 0;
  std::string frames;
  for (std::size_t i = 0; i < plan.places.size(); ++i) {
    if (plan.places[i].image != image) continue;
    planes += plan.places[i].bits;
    frames += " " + sequence.frames[i].file.substr(0, sequence.frames[i].file.rfind('.'));
  }
  char line[64];
  std::snprintf(line, sizeof line, "  %-13s %2d of %d bit planes:", lcr4500::image_file(image).c_str(), planes,
                kPlanesPerImage);
  return line + frames + "\n";
}

std::string load_text(const lcr4500::FlashPlan& plan) {
  const int preloaded = lcr4500::kPreloadedImages * kPlanesPerImage;
  if (plan.later_images() == 0) {
    return "all of them are in the projector's memory (" + std::to_string(preloaded) +
           " planes) before a capture begins: no load time\n";
  }
  char text[400];
  std::snprintf(
      text, sizeof text,
      "the projector's memory holds %d planes: %d image%s loaded during every capture, up to %u ms each, %u ms in "
      "all\nwhile an image is loaded, the one before it has to be shown for as long: the appliance spaces its "
      "frames out; fewer frames need less: `--sequence fast` of one axis needs none\n",
      preloaded, plan.later_images(), plan.later_images() == 1 ? " is" : "s are", lcr4500::kImageLoad_us / 1000,
      plan.load_us() / 1000);
  return text;
}

}  // namespace

std::vector<std::uint8_t> draw_pattern(const FrameSpec& frame, const ProjectorGrid& projector) {
  const std::size_t width = static_cast<std::size_t>(projector.width);
  std::vector<std::uint8_t> pixels(width * static_cast<std::size_t>(projector.height));
  for (int row = 0; row < projector.height; ++row) {
    for (int column = 0; column < projector.width; ++column) {
      const double x = lattice_coordinate(projector.layout, frame.axis, row, column);
      const auto level = static_cast<std::uint8_t>(255.0 * pattern_intensity(frame, x) + 0.5);
      pixels[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)] = level;
    }
  }
  return pixels;
}

Result<void> write_flash_images(const Sequence& sequence, const lcr4500::FlashPlan& plan,
                                const std::filesystem::path& folder, Progress& progress) {
  const auto frames = static_cast<int>(sequence.frames.size());
  for (int image = 0; image < plan.images; ++image) {
    contract_io::Picture picture(sequence.projector.height, sequence.projector.width);
    for (std::size_t i = 0; i < plan.places.size(); ++i) {
      if (plan.places[i].image != image) continue;
      add_planes(draw_pattern(sequence.frames[i], sequence.projector), plan.places[i], picture);
    }
    const contract_io::Picture& done = picture;
    const auto written = contract_io::write_bmp(folder / lcr4500::image_file(image), done.view());
    if (!written) return written;
    progress.show(frames + image + 1);
  }
  return {};
}

std::string plane_text(const FlashPlace& place) {
  const std::string first = plane_name(place.first_plane);
  return place.bits == 1 ? first : first + "-" + plane_name(place.first_plane + place.bits - 1);
}

std::string flash_text(const Sequence& sequence, const lcr4500::FlashPlan& plan) {
  std::string text = "flash images for the LightCrafter 4500, in the order in which its flash must hold them:\n";
  for (int image = 0; image < plan.images; ++image) text += image_line(sequence, plan, image);
  text += std::to_string(plan.planes) + " bit planes in " + std::to_string(plan.images) +
          (plan.images == 1 ? " image: " : " images: ");
  return text + load_text(plan);
}

}  // namespace beltpick::cli
