// The declared limits from which the appliance computes its memory. Never derived from the files loaded.
#pragma once

namespace beltpick {

struct Limits {
  int image_width = 1280;
  int image_height = 960;
  int frames = 32;              // of one sequence
  int decode_bytes = 16;        // a pixel, of the decoder's state: the named sequences take up to 16 for each axis
  bool code_rows = false;       // room for sequences that code projector rows, too
  int templates = 4;            // loaded at once
  int template_points = 40000;  // of one template
  int grid_cells = 6'000'000;   // of one template's closest-point grid
  int segments = 64;            // objects in one image
  int hypotheses = 4096;        // of one search
  int object_points = 4096;     // sampled from one object
  int parts = 32;               // located in one image
};

}  // namespace beltpick
