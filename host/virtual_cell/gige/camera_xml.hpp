// The GenICam description of the virtual camera: what Aravis and any other GigE Vision client reads to find its
// features.
#pragma once

#include <string>

namespace beltpick::virtual_cell::gige {

// The XML text; its addresses are those of registers.hpp.
std::string camera_xml();

}  // namespace beltpick::virtual_cell::gige
