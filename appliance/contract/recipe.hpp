// A recipe: what the appliance projects, how long it exposes, and which parts it looks for. beltpick-recipe, version 1:
//
//   {"format": "beltpick-recipe", "version": 1, "number": 1, "name": "knuckles",
//    "sequence": "standard",               fast, standard, robust, micro; the path of a sequence.json; its content
//    "axes": "column",                     column, row or both; for the named sequences
//    "exposure_us": 8000,                  for frames whose sequence does not tell their own
//    "exposures_us": [2000, 8000, 24000],  HDR: the whole sequence once at each of them, in place of exposure_us
//    "settle_us": 1000,                    from the projector's advance to the camera's pulse
//    "period_us": 20000,                   from frame to frame; 0: the shortest that camera and projector allow
//    "templates": ["knuckle.template"]}    part_number counts in this order, from 1
//
// `number`, `exposure_us` and `templates` are required. Defaults of the others: the file's stem, standard, column,
// none, 1000, 0. In a file, paths count from the recipe's folder. A recipe that the appliance keeps stands by itself:
// its templates are the names of the appliance's own ("knuckle" or "knuckle.template"), its sequence is a name or
// stands in it as an object {"projector": ..., "frames": [...]} of sequence.json's form.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "contract/sequences.hpp"

namespace beltpick {

struct Recipe {
  std::uint16_t number = 1;  // 1..65535, as the PLC selects it
  std::string name;
  std::string sequence = "standard";     // a SequenceName, or the path of a sequence.json
  std::optional<Sequence> own_sequence;  // stands in the recipe itself; `sequence` is then not used
  SequenceAxes axes = SequenceAxes::kColumn;
  double exposure_us = 0.0;
  std::vector<double> exposures_us;  // of an HDR capture; empty: one, exposure_us
  double settle_us = 1000.0;
  double period_us = 0.0;              // 0: the shortest possible
  std::vector<std::string> templates;  // paths, or the names of the appliance's items
};

}  // namespace beltpick
