// The text of capture.json and sequence.json.
#include <algorithm>
#include <map>

#include "contract/flash_plan.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/sequence_json.hpp"

namespace beltpick::contract_io {
namespace {

constexpr const char* kCaptureFormat = "beltpick-capture";
constexpr const char* kSequenceFormat = "beltpick-sequence";
constexpr int kVersion = 1;
constexpr int kMaxProjectorSide = 32768;
constexpr int kMaxFrames = 4096;

ProjectorGrid read_projector(JsonObject projector) {
  ProjectorGrid grid;
  grid.width = projector.integer("width", {1, kMaxProjectorSide});
  grid.height = projector.integer("height", {1, kMaxProjectorSide});
  grid.layout = static_cast<ProjectorLayout>(projector.choice("layout", {"square", "diamond"}, 0));
  projector.finish();
  return grid;
}

void read_phase(JsonObject& object, FrameSpec& frame) {
  frame.axis = static_cast<Axis>(object.choice("axis", {"column", "row"}));
  frame.period_px = object.number("period_px", {2.0, 1e6});
  frame.steps = object.integer("steps", {3, 1024});
  frame.step = object.integer("step", {0, static_cast<double>(frame.steps - 1)});
  frame.offset_rad = object.number("offset_rad", {-1e6, 1e6}, 0.0);
}

void read_gray(JsonObject& object, FrameSpec& frame) {
  frame.axis = static_cast<Axis>(object.choice("axis", {"column", "row"}));
  frame.cell_px = object.number("cell_px", {0.0, 1e6, true});
  frame.bit = object.integer("bit", {0, 30});
  frame.inverted = object.flag("inverted", false);
}

// A file beside capture.json, never one that the name leads away to.
void check_file_name(JsonObject& object, const std::string& file) {
  const std::filesystem::path path(file);
  const bool leads_away = path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
  if (file.empty() || leads_away || file.find('\0') != std::string::npos) {
    object.fail(ResultCode::kValueOutOfRange, "file", "the name of an image beside the file", "\"" + file + "\"");
  }
}

FrameSpec read_frame(JsonObject& object) {
  FrameSpec frame;
  frame.file = object.text("file");
  check_file_name(object, frame.file);
  frame.kind = static_cast<FrameKind>(object.choice("kind", {"phase", "gray", "white", "black"}));
  frame.exposure_us = object.number("exposure_us", {0.0, 1e9}, 0.0);
  if (frame.kind == FrameKind::kPhase) read_phase(object, frame);
  if (frame.kind == FrameKind::kGray) read_gray(object, frame);
  if (frame.kind == FrameKind::kWhite || frame.kind == FrameKind::kBlack) object.ignore("axis");
  object.finish();
  return frame;
}

void warn_of_repeated_files(const Sequence& sequence, JsonDocument& document) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const auto [at, is_new] = first.emplace(sequence.frames[i].file, i);
    if (is_new) continue;
    document.warn("frames[" + std::to_string(i) + "].file: '" + sequence.frames[i].file + "' is also that of frames[" +
                  std::to_string(at->second) + "]; is one of them meant to be another?");
  }
}

// "flash": {"images": [files], "frames": [{"image": 0, "first_plane": 0, "bits": 8}, ...]}; what else stands there is
// for people.
std::vector<FlashPlace> read_flash(JsonObject flash) {
  std::vector<FlashPlace> places;
  flash.ignore("plane_order");
  flash.ignore("images");
  for (JsonObject& frame : flash.objects("frames")) {
    FlashPlace place;
    place.image = frame.integer("image", {0, kMaxFrames});
    place.first_plane = frame.integer("first_plane", {0, lcr4500::kPlanesPerImage - 1});
    place.bits = frame.integer("bits", {1, 8});
    frame.finish();
    places.push_back(place);
  }
  flash.finish();
  return places;
}

Json flash_json(const std::vector<FlashPlace>& places) {
  Json frames = Json::array();
  for (const FlashPlace& place : places) {
    frames.push_back({{"image", place.image}, {"first_plane", place.first_plane}, {"bits", place.bits}});
  }
  Json images = Json::array();
  for (int i = 0; i <= places.back().image; ++i) images.push_back(lcr4500::image_file(i));
  return {{"plane_order", "G0..G7 R0..R7 B0..B7"}, {"images", std::move(images)}, {"frames", std::move(frames)}};
}

Json to_json(const FrameSpec& frame) {
  static constexpr const char* kKinds[] = {"phase", "gray", "white", "black"};
  Json json = {{"file", frame.file}, {"kind", kKinds[static_cast<std::size_t>(frame.kind)]}};
  if (frame.kind == FrameKind::kPhase || frame.kind == FrameKind::kGray) {
    json["axis"] = frame.axis == Axis::kColumn ? "column" : "row";
  }
  if (frame.kind == FrameKind::kPhase) {
    json.update({{"period_px", frame.period_px},
                 {"steps", frame.steps},
                 {"step", frame.step},
                 {"offset_rad", frame.offset_rad}});
  }
  if (frame.kind == FrameKind::kGray) {
    json.update({{"cell_px", frame.cell_px}, {"bit", frame.bit}, {"inverted", frame.inverted}});
  }
  if (frame.exposure_us > 0) json["exposure_us"] = frame.exposure_us;
  return json;
}

}  // namespace

Sequence read_sequence_members(JsonDocument& document, JsonObject& root) {
  Sequence sequence;
  sequence.projector = read_projector(root.object("projector"));
  std::vector<JsonObject> frames = root.objects("frames");
  if (!document.failed() && (frames.empty() || frames.size() > kMaxFrames)) {
    root.fail(ResultCode::kValueOutOfRange, "frames", "between 1 and " + std::to_string(kMaxFrames) + " frames",
              std::to_string(frames.size()));
  }
  for (JsonObject& frame : frames) {
    if (document.failed()) break;
    sequence.frames.push_back(read_frame(frame));
  }
  if (!document.failed()) warn_of_repeated_files(sequence, document);
  if (root.is_object("flash")) sequence.flash = read_flash(root.object("flash"));
  return sequence;
}

void append_sequence(const Sequence& sequence, Json& json) {
  const bool diamond = sequence.projector.layout == ProjectorLayout::kDiamond;
  json["projector"] = {{"width", sequence.projector.width},
                       {"height", sequence.projector.height},
                       {"layout", diamond ? "diamond" : "square"}};
  Json frames = Json::array();
  for (const FrameSpec& frame : sequence.frames) frames.push_back(to_json(frame));
  json["frames"] = std::move(frames);
  if (!sequence.flash.empty()) json["flash"] = flash_json(sequence.flash);
}

Result<CaptureHeader> parse_capture(std::string_view text, const std::string& name, Warnings& warnings) {
  JsonDocument document(text, name, warnings);
  JsonObject root = document.root({kCaptureFormat, kSequenceFormat}, kVersion);
  CaptureHeader header;
  header.id = root.text("id", "");
  header.full_scale = root.integer("full_scale", {1, 65535}, 0);
  header.sequence = read_sequence_members(document, root);
  root.finish();
  if (document.failed()) return document.error();
  return header;
}

Result<void> write_capture(const std::filesystem::path& path, const CaptureHeader& header) {
  Json json = {{"format", kCaptureFormat}, {"version", kVersion}};
  if (!header.id.empty()) json["id"] = header.id;
  json["full_scale"] = header.full_scale;
  append_sequence(header.sequence, json);
  return write_file(path, json_text(json));
}

Result<Sequence> read_sequence(const std::filesystem::path& path, Warnings& warnings) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  JsonDocument document(*text, one_line(path.string()), warnings);
  JsonObject root = document.root({kSequenceFormat, kCaptureFormat}, kVersion);
  root.ignore("id");
  root.ignore("full_scale");
  const Sequence sequence = read_sequence_members(document, root);
  root.finish();
  if (document.failed()) return document.error();
  return sequence;
}

Result<void> write_sequence(const std::filesystem::path& path, const Sequence& sequence) {
  Json json = {{"format", kSequenceFormat}, {"version", kVersion}};
  append_sequence(sequence, json);
  return write_file(path, json_text(json));
}

}  // namespace beltpick::contract_io
