// ObjectBook: what is found cheaply is searched first, nothing twice as it is, and every object has a last word.
#include <array>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "contract/result_codes.hpp"
#include "pipeline/object_book.hpp"
#include "support/scenes/models.hpp"

using namespace beltpick;
using beltpick::pipeline::Attempt;
using beltpick::pipeline::Effort;
using beltpick::pipeline::Object;

namespace {

constexpr int kRows = 100, kCols = 200;
constexpr double kSmallestView_mm2 = 1000.0;

// A flat image at 1 mm a pixel, with rectangles for objects.
struct Sheet {
  std::vector<Vec3f> points = std::vector<Vec3f>(kRows * kCols, Vec3f(0.0F, 0.0F, 500.0F));
  std::vector<float> sigma = std::vector<float>(kRows * kCols, 0.05F);
  std::vector<std::uint16_t> labels = std::vector<std::uint16_t>(kRows * kCols, 0);
  std::vector<Segment> segments;
  result::Scene scene;

  Sheet() {
    scene.range.point_mm = {points.data(), kRows, kCols};
    scene.labels = {labels.data(), kRows, kCols};
    scene.lens.fx_px = scene.lens.fy_px = 500.0;
  }
  void add(int row, int col, int rows, int cols) {
    Segment segment;
    segment.label = static_cast<std::uint16_t>(segments.size() + 1);
    segment.row_min = row, segment.row_max = row + rows - 1, segment.col_min = col, segment.col_max = col + cols - 1;
    segment.pixels = rows * cols;
    for (int r = row; r < row + rows; ++r) {
      for (int c = col; c < col + cols; ++c) labels[static_cast<std::size_t>(r * kCols + c)] = segment.label;
    }
    segments.push_back(segment);
  }
};

Attempt withheld(ResultCode code, Stage stage = Stage::kVerify, double strength = 0.1) {
  Attempt attempt;
  attempt.stage = stage;
  attempt.reason = failure(code, "in vain").error();
  attempt.best.strength = strength;
  return attempt;
}

using Book = test::InArena<pipeline::ObjectBook>;

std::vector<int> first_labels(std::span<const Object> objects) {
  std::vector<int> labels;
  for (const Object& object : objects) labels.push_back(object.labels[0]);
  return labels;
}

// Every round until nothing is left, each search in vain for this reason: "effort: first labels" of each.
std::vector<std::string> all_rounds(pipeline::ObjectBook& book, const result::Scene& scene, const Attempt& outcome) {
  std::vector<std::string> rounds;
  for (auto objects = book.next_round(scene, 20.0); !objects.empty() && rounds.size() < 50;
       objects = book.next_round(scene, 20.0)) {
    std::string text = std::to_string(static_cast<int>(book.effort())) + ":";
    for (const Object& object : objects) {
      for (int i = 0; i < object.label_count; ++i) text += (i == 0 ? " " : "+") + std::to_string(object.labels[i]);
      book.failed(object, outcome);
    }
    rounds.push_back(text);
  }
  return rounds;
}

}  // namespace

TEST_CASE(
    "whole objects come before fragments, little effort before much, and pieces are joined before views and last") {
  Sheet sheet;
  sheet.add(0, 0, 40, 40);    // whole
  sheet.add(0, 100, 10, 20);  // two fragments, near each other
  sheet.add(0, 125, 10, 20);
  sheet.add(80, 150, 5, 5);  // dirt
  Book book(test::test_limits());
  book.made.begin(sheet.scene, sheet.segments, kSmallestView_mm2);
  CHECK(all_rounds(book.made, sheet.scene, withheld(ResultCode::kFreeSpaceViolated)) ==
        std::vector<std::string>{"0: 1", "1: 1", "3: 1", "0: 2 3", "1: 2 3", "2: 2+3", "3: 2 3", "4: 1 2 3", "6: 2+3"});
  std::array<WithheldObject, 8> out;
  REQUIRE(book.made.withheld(out) == 4);
  CHECK(out[3].reason.code == ResultCode::kObjectTooSmall);
}

TEST_CASE("pieces that were searched together are searched so again when some of them is gone, and not before") {
  const test::LoadedPart loaded(test::bracket());
  Sheet sheet;
  sheet.add(0, 0, 10, 40);
  sheet.add(20, 0, 10, 40);
  const Attempt in_vain = withheld(ResultCode::kCoverageTooLow);
  for (const bool some_gone : {false, true}) {
    Book book(test::test_limits());
    book.made.begin(sheet.scene, sheet.segments, kSmallestView_mm2);
    do {
      for (const Object& object : book.made.next_round(sheet.scene, 20.0)) book.made.failed(object, in_vain);
    } while (book.made.effort() != Effort::kPieces);
    result::PartPose pose;
    pose.translation_mm = Vec3(0.0, 0.0, 500.0) - loaded.model().surface.front().point_mm.cast<double>();
    if (some_gone) book.made.explain(sheet.scene, loaded.model(), pose, {0, 9, 0, 3});
    const auto rounds = all_rounds(book.made, sheet.scene, in_vain);
    CHECK(rounds == (some_gone ? std::vector<std::string>{"3: 1 2", "4: 1 2", "5: 1+2", "6: 1+2"}
                               : std::vector<std::string>{"3: 1 2", "4: 1 2", "6: 1+2"}));
  }
}

TEST_CASE("neighbourhoods are not searched where no pose came near, nor where one is ambiguous") {
  Sheet sheet;
  sheet.add(0, 0, 40, 40);
  for (const Attempt& outcome :
       {withheld(ResultCode::kNoHypothesis, Stage::kSearch), withheld(ResultCode::kPoseAmbiguous)}) {
    Book book(test::test_limits());
    book.made.begin(sheet.scene, sheet.segments, kSmallestView_mm2);
    CHECK(all_rounds(book.made, sheet.scene, outcome) == std::vector<std::string>{"0: 1", "1: 1", "3: 1"});
  }
}

TEST_CASE("an object has its last word when no more is tried, and it is the attempt that came nearest") {
  Sheet sheet;
  sheet.add(0, 0, 40, 40);
  Book book(test::test_limits());
  book.made.begin(sheet.scene, sheet.segments, kSmallestView_mm2);
  const std::array<Attempt, 3> attempts{withheld(ResultCode::kCoverageTooLow, Stage::kVerify, 0.3),
                                        withheld(ResultCode::kPoseAmbiguous, Stage::kVerify, 0.8),
                                        withheld(ResultCode::kNoHypothesis, Stage::kSearch, 0.9)};
  for (const Attempt& attempt : attempts) {
    const auto objects = book.made.next_round(sheet.scene, 20.0);
    REQUIRE(first_labels(objects) == std::vector<int>{1});
    CHECK(book.made.last_word(objects[0]) == nullptr);
    book.made.failed(objects[0], attempt);
  }
  Object object;
  object.add(sheet.segments[0]);
  REQUIRE(book.made.last_word(object) != nullptr);
  CHECK(book.made.last_word(object)->ambiguous());
}

TEST_CASE("what a found part leaves of an object is searched from the beginning, and only if it is enough") {
  const test::LoadedPart loaded(test::bracket());
  Sheet sheet;
  sheet.add(0, 0, 40, 60);
  Book book(test::test_limits());
  book.made.begin(sheet.scene, sheet.segments, kSmallestView_mm2);
  REQUIRE(first_labels(book.made.next_round(sheet.scene, 20.0)) == std::vector<int>{1});
  Object object;
  object.add(sheet.segments[0]);
  book.made.failed(object, withheld(ResultCode::kCoverageTooLow));
  // All points of the sheet are one point: a part there explains every pixel of the region given.
  result::PartPose pose;
  pose.translation_mm = Vec3(0.0, 0.0, 500.0) - loaded.model().surface.front().point_mm.cast<double>();
  book.made.explain(sheet.scene, loaded.model(), pose, {0, 39, 0, 29});
  REQUIRE(first_labels(book.made.next_round(sheet.scene, 20.0)) == std::vector<int>{1});
  CHECK(book.made.effort() == Effort::kPrimitives);
  book.made.explain(sheet.scene, loaded.model(), pose, {0, 39, 0, 58});
  CHECK(book.made.next_round(sheet.scene, 20.0).empty());
}

TEST_CASE("an ambiguous attempt at any segment is remembered") {
  Sheet sheet;
  sheet.add(0, 0, 40, 60);
  sheet.add(50, 0, 40, 60);
  Book book(test::test_limits());
  book.made.begin(sheet.scene, sheet.segments, kSmallestView_mm2);
  const auto objects = book.made.next_round(sheet.scene, 20.0);
  REQUIRE(objects.size() == 2);
  const auto any = [](const Attempt&) { return true; };
  const auto weak = [](const Attempt& attempt) { return attempt.best.strength < 0.4; };
  const Object first = objects[0], second = objects[1];
  book.made.failed(first, withheld(ResultCode::kCoverageTooLow, Stage::kVerify, 0.3));
  CHECK_FALSE(book.made.any_ambiguous(any));
  book.made.failed(second, withheld(ResultCode::kPoseAmbiguous, Stage::kVerify, 0.5));
  CHECK(book.made.any_ambiguous(any));
  CHECK_FALSE(book.made.any_ambiguous(weak));
}
