#include "board_options.hpp"

#include "calibrate/board_corners.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"

namespace beltpick::cli {

void add_board_options(CLI::App& app, BoardOptions& options) {
  app.add_option("--board", options.size, "inner corners of the print, columns x rows")->type_name("11x8");
  app.add_option("--square-mm", options.square_mm, "side of a square, as measured");
  app.add_flag("--charuco", options.charuco, "the plate is a ChArUco board");
  app.add_option("--marker-mm", options.marker_mm, "side of its markers (default: 0.75 of a square)");
  app.add_option("--dictionary", options.dictionary, "of its markers, as OpenCV names it")->capture_default_str();
}

Result<calibrate::Board> board_of(const BoardOptions& options) {
  if (options.size.empty() || !(options.square_mm > 0.0)) {
    return failure(ResultCode::kUsage, "expected --board and --square-mm of the plate, such as 11x8 and 20, found %s",
                   options.size.empty() ? "no --board" : "no --square-mm");
  }
  const auto size = parse_size(options.size, "--board");
  if (!size) return std::unexpected(size.error());
  calibrate::Board board{size->width, size->height, options.square_mm};
  if (options.charuco) {
    board.marker_mm = options.marker_mm > 0.0 ? options.marker_mm : 0.75 * options.square_mm;
    board.dictionary = options.dictionary;
  }
  if (auto checked = calibrate::check_board(board); !checked) return std::unexpected(checked.error());
  return board;
}

}  // namespace beltpick::cli
