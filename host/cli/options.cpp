#include "options.hpp"

#include <cstdio>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::cli {

void example(CLI::App& app, const std::string& lines) { app.footer("Example:\n" + lines); }

Result<SizePx> parse_size(const std::string& text, const char* option) {
  SizePx size;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%6dx%6d%c", &size.width, &size.height, &rest);
  if (read != 2 || size.width <= 0 || size.height <= 0) {
    return failure(ResultCode::kUsage, "%s: expected WIDTHxHEIGHT such as 912x1140, found '%s'", option,
                   contract_io::one_line(text).substr(0, 60).c_str());
  }
  return size;
}

}  // namespace beltpick::cli
