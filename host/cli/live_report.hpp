// The virtual cell's report as JSON and as lines for people.
#pragma once

#include <string>

#include "contract_io/json_writer.hpp"
#include "virtual_cell/world/cell_report.hpp"

namespace beltpick::cli {

contract_io::Json report_json(const virtual_cell::CellReport& report);
std::string report_text(const virtual_cell::CellReport& report);
std::string view_line(const virtual_cell::ViewRecord& view);

}  // namespace beltpick::cli
