#include "plate_capture.hpp"

#include <memory>

#include "calibrate/board_corners.hpp"
#include "calibrate/flat_image.hpp"
#include "calibrate/projector_corners.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "measured_capture.hpp"

namespace beltpick::cli {

Result<PlateCapture> read_plate(const std::filesystem::path& path, const calibrate::Board& board,
                                contract_io::Warnings& warnings, bool quiet) {
  std::unique_ptr<calibrate::FlatImage> flat;
  const auto measured = MeasuredCapture::make(
      path, std::nullopt, warnings, quiet,
      [&](const CaptureHeader& header, int index, const contract_io::GreyImage& image) {
        if (!flat) {
          flat = std::make_unique<calibrate::FlatImage>(header.sequence, image.rows, image.cols, header.full_scale);
        }
        image.bits == 8 ? flat->add(index, image.view8()) : flat->add(index, image.view16());
      });
  if (!measured) return std::unexpected(measured.error());
  const std::string name = contract_io::one_line(path.string());
  const CodeImage& code = (*measured)->code();
  if (code.column_px.empty() || code.row_px.empty()) {
    return failure(ResultCode::kSequenceUndecodable,
                   "%s: expected a sequence that codes both axes, found the projector's %s only; capture one made by "
                   "'beltpick patterns --axes both'",
                   name.c_str(), code.row_px.empty() ? "columns" : "rows");
  }
  const ImageView<const float> image = flat->finish();
  const auto corners = calibrate::find_board(board, image);
  if (!corners) return failure(corners.error().code, "%s: %s", name.c_str(), corners.error().detail);
  PlateCapture plate{{(*measured)->header().id, {}}, image.cols, image.rows, (*measured)->header().sequence.projector};
  const std::vector<double> spacing_px = calibrate::corner_spacing_px(board, *corners);
  for (std::size_t i = 0; i < corners->size(); ++i) {
    calibrate::ObservedCorner corner;
    corner.corner = (*corners)[i].corner;
    corner.camera_px = (*corners)[i].at_px;
    calibrate::fit_projector_corner(code, image, spacing_px[i], corner);
    plate.pose.corners.push_back(std::move(corner));
  }
  return plate;
}

}  // namespace beltpick::cli
