#include <catch2/catch.hpp>

#include "app/run_book.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {
WithheldObject object(ResultCode code) { return {1, Stage::kVerify, failure(code, "test").error()}; }
}  // namespace

TEST_CASE("only what the last view of a cycle withheld goes to the tray", "[book]") {
  RunBook book;
  const WithheldObject hidden[] = {object(ResultCode::kObstructed), object(ResultCode::kCoverageTooLow)};
  const WithheldObject foreign[] = {object(ResultCode::kNoHypothesis)};
  book.set_view(2, hidden);
  book.set_view(1, foreign);
  book.add_release();
  book.add_release();
  const auto totals = book.totals();
  CHECK(totals.found == 3);
  REQUIRE(totals.withheld.size() == 1);
  CHECK(totals.withheld[0].code == ResultCode::kNoHypothesis);
  CHECK(totals.withheld[0].count == 1);
}

TEST_CASE("the belt's place is that told last", "[book]") {
  RunBook book;
  CHECK_FALSE(book.belt_nearer_mm());
  book.set_belt_nearer(0.25);
  CHECK(book.belt_nearer_mm() == 0.25);
  book.set_belt_nearer(std::nullopt);
  CHECK_FALSE(book.belt_nearer_mm());
}

TEST_CASE("the pixels are those of the latest capture", "[book]") {
  RunBook book;
  CHECK(book.pixels() == PixelCounts{});
  std::array<PixelState, 6> states{PixelState::kValid, PixelState::kSaturated, PixelState::kValid,
                                   PixelState::kMoved, PixelState::kValid,     PixelState::kEdge};
  book.set_pixels({9, 9, 9, 9, 9, 9, 9});
  book.set_pixels(count_pixels({states.data(), 2, 3}));
  CHECK(book.pixels() == PixelCounts{3, 0, 1, 0, 0, 1, 1});
}

TEST_CASE("medians are of the latest samples, also when there are very many", "[book]") {
  RunBook book;
  for (int i = 1; i <= 5; ++i) book.add_time(Step::kDecode, i);
  CHECK(book.totals().median_ms[static_cast<std::size_t>(Step::kDecode)] == 3.0);
  for (int i = 0; i < 10000; ++i) book.add_time(Step::kDecode, 40.0);
  CHECK(book.totals().median_ms[static_cast<std::size_t>(Step::kDecode)] == 40.0);
  CHECK(book.totals().median_ms[static_cast<std::size_t>(Step::kRange)] == 0.0);
}

TEST_CASE("the summary is one line of JSON with codes by name", "[book]") {
  RunBook book;
  book.add_cycle();
  book.add_fault(ResultCode::kRobotInView);
  book.add_fault(ResultCode::kRobotInView);
  const Arena::Share shares[] = {{"range image", 2'000'000}};
  const std::string text = summary_text(book, shares);
  CHECK(text.find('\n') == text.size() - 1);
  CHECK(text.find("\"ROBOT_IN_VIEW\":2") != std::string::npos);
  CHECK(text.find("\"total_mb\":2.0") != std::string::npos);
  CHECK(resident_mb() > 1.0);
  CHECK(peak_resident_mb() >= resident_mb());
}
