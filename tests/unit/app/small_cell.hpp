// A cell's files, small enough for unit tests: calibration of a 64 x 48 camera, cell, two recipes, two templates.
#pragma once

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "app/settings.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/recipe_io.hpp"
#include "contract_io/template_io.hpp"

namespace beltpick::app {

struct SmallCell {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("beltpick_small_cell_" + std::to_string(getpid()));
  Settings settings;

  SmallCell() {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    Calibration calibration;
    calibration.id = "small";
    calibration.camera_serial = "CAM1";
    calibration.camera = {64, 48, 80, 80, 32, 24, {}};
    calibration.projector = {128, 96, 100, 100, 64, 48, {}};
    calibration.T_projector_camera.translation_mm = {200, 0, 0};
    REQUIRE(contract_io::write_calibration(folder / "calibration.json", calibration));
    Cell cell;
    cell.calibration_id = "small";
    cell.T_belt_camera.emplace();
    REQUIRE(contract_io::write_cell(folder / "cell.json", cell));
    write_template("one.template", 600);
    write_template("two.template", 3000);
    write_recipe("first.json", 1, "one.template");
    write_recipe("second.json", 2, "two.template");
    settings.folder = folder;
    settings.recipes = {"first.json", "second.json"};
    settings.limits.image_width = 64;
    settings.limits.image_height = 48;
    settings.limits.template_points = 5000;
    settings.limits.grid_cells = 200'000;
    settings.limits.templates = 2;
  }
  ~SmallCell() { std::filesystem::remove_all(folder); }
  SmallCell(const SmallCell&) = delete;
  SmallCell& operator=(const SmallCell&) = delete;

  // Points all over a sphere of 20 mm.
  void write_template(const std::string& name, int points) const {
    PartTemplate part;
    for (int i = 0; i < points; ++i) {
      const double z = 1.0 - 2.0 * (i + 0.5) / points, turn = 2.399963 * i, r = std::sqrt(1.0 - z * z);
      const Vec3f normal(Vec3(r * std::cos(turn), r * std::sin(turn), z).cast<float>());
      part.normal.push_back(normal);
      part.point_mm.push_back(20.0F * normal);
    }
    part.spacing_mm = 70.0 / std::sqrt(points);
    part.box_min_mm = Vec3::Constant(-20);
    part.box_max_mm = Vec3::Constant(20);
    part.grasps.resize(1);
    part.grasps[0].name = "top";
    part.grasps[0].opening_mm = 50;
    REQUIRE(contract_io::write_template(folder / name, part));
  }

  void write_recipe(const std::string& name, std::uint16_t number, const std::string& part) const {
    Recipe recipe;
    recipe.number = number;
    recipe.name = name;
    recipe.sequence = "fast";
    recipe.exposure_us = 5000;
    recipe.templates = {part};
    REQUIRE(contract_io::write_recipe(folder / name, recipe));
  }
};

}  // namespace beltpick::app
