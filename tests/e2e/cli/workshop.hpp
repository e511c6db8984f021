// A small rendered capture, its calibration and a template, made once for the tests of a program.
#pragma once

#include <catch2/catch.hpp>

#include "support/run_program.hpp"

namespace beltpick::test {

// Holds scene/ (the capture with calibration.json, cell.json, sequence.json), knuckle.stl and knuckle.template.
inline const TempFolder& workshop() {
  static const TempFolder folder;
  static const bool made = [] {
    const std::string scene = (folder / "scene").string();
    const Outcome simulated = beltpick_run("simulate --camera 160x120 --projector 152x190 --seed 3 --out " + scene +
                                           " --write-parts " + folder.path().string());
    INFO(simulated.err);
    REQUIRE(simulated.exit_code == 0);
    const Outcome taught = beltpick_run("teach " + (folder / "knuckle.stl").string() + " --points 500 --out " +
                                        (folder / "knuckle.template").string());
    INFO(taught.err);
    REQUIRE(taught.exit_code == 0);
    return true;
  }();
  (void)made;
  return folder;
}

}  // namespace beltpick::test
