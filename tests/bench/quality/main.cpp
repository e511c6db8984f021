// What is right, wrong and masked, over scenes of the virtual cell, against its truth:
//   bench_quality [name=value ...]
// seed=1 count=2                   the first seed, and how many scenes of each kind
// scenes=plane,bare,parts          matt plane, bare belt, cast-metal parts on the belt
// sequence=fast,standard,robust    or 4-step (standard with so many steps), or the path of a sequence.json
// parts=knuckle,elbow,bracket      or mesh files
// exposures_us=2000,8000           an HDR sequence of these exposures
// gamma=1.03                       of the projector
// noise=1                          0: no noise, flicker or sway
// interreflection=0                1: the light that surfaces throw on each other; parts=vblock has much of it
// Prints a table, and one line of JSON a row of it.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>

#include "bench/quality/judge.hpp"
#include "contract/sequences.hpp"
#include "contract_io/capture_io.hpp"

namespace beltpick::bench {
namespace {

using Options = std::map<std::string, std::string>;

std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> items;
  std::stringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) items.push_back(item);
  return items;
}

Options read_options(int argc, char** argv) {
  Options options{{"seed", "1"},
                  {"count", "2"},
                  {"scenes", "plane,bare,parts"},
                  {"sequence", "fast,standard,robust"},
                  {"parts", "knuckle,elbow,bracket"},
                  {"exposures_us", ""},
                  {"gamma", "1.03"},
                  {"noise", "1"},
                  {"interreflection", "0"}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t at = argument.find('=');
    if (at == std::string::npos || !options.contains(argument.substr(0, at))) {
      throw std::runtime_error("expected name=value of the list at the head of the source, found '" + argument + "'");
    }
    options[argument.substr(0, at)] = argument.substr(at + 1);
  }
  return options;
}

// `standard` with another number of steps.
Sequence with_steps(const Sequence& standard, int steps) {
  Sequence sequence{standard.projector, {}, {}};
  for (FrameSpec frame : standard.frames) {
    if (frame.kind != FrameKind::kPhase) {
      sequence.frames.push_back(frame);
    } else if (frame.step == 0) {
      frame.steps = steps;
      for (frame.step = 0; frame.step < steps; ++frame.step) sequence.frames.push_back(frame);
    }
  }
  return sequence;
}

Result<Sequence> find_sequence(const std::string& name, const ProjectorGrid& grid) {
  if (const auto named = find_sequence_name(name)) return make_sequence(*named, grid, SequenceAxes::kColumn);
  if (name.ends_with("-step")) {
    auto standard = make_sequence(SequenceName::kStandard, grid, SequenceAxes::kColumn);
    return standard ? Result<Sequence>(with_steps(*standard, std::atoi(name.c_str()))) : standard;
  }
  contract_io::Warnings warnings;
  return contract_io::read_sequence(name, warnings);
}

Sequence sequence_of(const std::string& name, const ProjectorGrid& grid, const std::string& exposures_us) {
  auto made = find_sequence(name, grid);
  if (!made) throw std::runtime_error(made.error().detail);
  const auto exposures = list_of(exposures_us);
  if (exposures.empty()) return *made;
  Sequence repeated{made->projector, {}, {}};
  for (const std::string& exposure_us : exposures) {
    for (FrameSpec frame : made->frames) {
      frame.exposure_us = std::atof(exposure_us.c_str());
      repeated.frames.push_back(frame);
    }
  }
  return repeated;
}

double finest_period_px(const Sequence& sequence) {
  double finest = 1e9;
  for (const FrameSpec& frame : sequence.frames) {
    if (frame.kind == FrameKind::kPhase) finest = std::min(finest, frame.period_px);
    if (frame.kind == FrameKind::kGray) finest = std::min(finest, 2.0 * frame.cell_px);
  }
  return finest;
}

SceneChoice::Kind kind_of(const std::string& name) {
  if (name == "plane") return SceneChoice::Kind::kPlane;
  if (name == "bare") return SceneChoice::Kind::kBare;
  if (name == "parts") return SceneChoice::Kind::kParts;
  throw std::runtime_error("scenes: expected plane, bare or parts, found '" + name + "'");
}

double percent(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

void print(const std::string& scenes, const std::string& sequence, const Tally& t) {
  std::printf("%s, %s\n", scenes.c_str(), sequence.c_str());
  std::printf("  apart from depth edges: %.3f %% of %lld lit pixels valid; %lld of %lld points off by a period\n",
              percent(t.points, t.lit), static_cast<long long>(t.lit), static_cast<long long>(t.period_errors),
              static_cast<long long>(t.points));
  std::printf("  ripple: %.5f px RMS, %.5f px uncorrected\n", t.ripple_px, t.uncorrected_ripple_px);
  if (t.part_points > 0) {
    std::printf("  on parts, apart from edges: %lld of %lld points off by over 0.5 mm\n",
                static_cast<long long>(t.part_off_half_mm), static_cast<long long>(t.part_points));
    std::printf("  within 2 pixels of a depth edge: %.2f %% of %lld points off by over 1 mm; kept %.1f %% of the lit\n",
                percent(t.band_off, t.band_points), static_cast<long long>(t.band_points),
                percent(t.band_points, t.band_lit));
    std::printf("  within 2 pixels of a shadow's border: %.2f %% of %lld points off by over 1 mm\n",
                percent(t.shadow_off, t.shadow_points), static_cast<long long>(t.shadow_points));
    std::printf(
        "  completeness below 70 degrees: %.2f %% of %lld (dropped %lld, dark %lld, saturated %lld, low "
        "modulation %lld, order %lld, edge %lld)\n",
        percent(t.complete, t.eligible), static_cast<long long>(t.eligible), static_cast<long long>(t.missing[0]),
        static_cast<long long>(t.missing[1]), static_cast<long long>(t.missing[2]),
        static_cast<long long>(t.missing[3]), static_cast<long long>(t.missing[4]),
        static_cast<long long>(t.missing[5]));
  }
  std::printf(
      "{\"scenes\": \"%s\", \"sequence\": \"%s\", \"points\": %lld, \"period_errors\": %lld, \"part_points\": %lld, "
      "\"part_off_half_mm\": %lld, \"band_points\": %lld, \"band_off_share\": %.5f, \"band_kept_share\": %.4f, "
      "\"completeness\": %.5f, \"ripple_px\": %.6f, \"uncorrected_ripple_px\": %.6f}\n",
      scenes.c_str(), sequence.c_str(), static_cast<long long>(t.points), static_cast<long long>(t.period_errors),
      static_cast<long long>(t.part_points), static_cast<long long>(t.part_off_half_mm),
      static_cast<long long>(t.band_points), percent(t.band_off, t.band_points) / 100.0,
      percent(t.band_points, t.band_lit) / 100.0, percent(t.complete, t.eligible) / 100.0, t.ripple_px,
      t.uncorrected_ripple_px);
  std::fflush(stdout);
}

void run(const Options& options) {
  for (const std::string& scenes : list_of(options.at("scenes"))) {
    SceneChoice choice;
    choice.kind = kind_of(scenes);
    choice.parts = list_of(options.at("parts"));
    choice.render.projector_gamma = std::atof(options.at("gamma").c_str());
    choice.render.interreflection = std::atof(options.at("interreflection").c_str());
    choice.render.noise = options.at("noise") != "0";
    VirtualCapture capture(choice);
    for (const std::string& name : list_of(options.at("sequence"))) {
      const Sequence sequence = sequence_of(name, capture.grid(), options.at("exposures_us"));
      Tally total;
      const int count = std::atoi(options.at("count").c_str());
      for (int k = 0; k < count; ++k) {
        capture.expose(sequence, std::strtoull(options.at("seed").c_str(), nullptr, 10) + static_cast<unsigned>(k));
        const std::vector<PixelTruth> truth = truth_of(capture);
        const double period_px = finest_period_px(sequence);
        total.uncorrected_ripple_px += ripple_rms_px(capture, capture.measure(false), truth, period_px) / count;
        const Measurement measured = capture.measure();
        total.ripple_px += ripple_rms_px(capture, measured, truth, period_px) / count;
        total.add(judge(capture, measured, truth, period_px));
      }
      print(scenes, name, total);
    }
  }
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  try {
    beltpick::bench::run(beltpick::bench::read_options(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_quality: %s\n", error.what());
    return 1;
  }
}
