// A small rendered capture, its calibration and a template, made once for the tests of a program; and the step of
// which such things are made.
#pragma once

#include <catch2/catch.hpp>

#include "support/run_program.hpp"

namespace beltpick::test {

// Runs `beltpick ARGUMENTS`, which has to succeed.
inline void must_run(const std::string& arguments) {
  const Outcome outcome = beltpick_run(arguments);
  INFO(arguments << ": " << outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

// Holds scene/ (the capture with calibration.json, cell.json, sequence.json), knuckle.stl and knuckle.template.
inline const TempFolder& workshop() {
  static const TempFolder folder;
  static const bool made = [] {
    must_run("simulate --camera 160x120 --projector 152x190 --seed 3 --out " + (folder / "scene").string() +
             " --write-parts " + folder.path().string());
    must_run("teach " + (folder / "knuckle.stl").string() + " --points 500 --views 0 --out " +
             (folder / "knuckle.template").string());
    return true;
  }();
  (void)made;
  return folder;
}

}  // namespace beltpick::test
