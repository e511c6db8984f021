// Writes small numbers into a picture, to tell which object is which.
#pragma once

#include "contract_io/pictures.hpp"

namespace beltpick::cli {

// Draws `number` in white on black, centred at (row, col); what reaches over the picture's edge is cut off. `scale`:
// picture pixels to a dot of the 3x5 digits.
void stamp_number(contract_io::Picture& picture, int row, int col, unsigned number, int scale);

}  // namespace beltpick::cli
