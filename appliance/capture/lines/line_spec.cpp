#include "capture/lines/line_spec.hpp"

#include <charconv>
#include <sstream>

#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {

Result<void> take_option(LineSpec& spec, const std::string& word) {
  if (word == "active-low") {
    spec.active_low = true;
  } else if (word == "pull-up") {
    spec.bias = LineBias::kPullUp;
  } else if (word == "pull-down") {
    spec.bias = LineBias::kPullDown;
  } else {
    return failure(ResultCode::kValueOutOfRange, "expected %s, found '%s'", kLineSpecForm, word.c_str());
  }
  return {};
}

}  // namespace

Result<LineSpec> parse_line_spec(const std::string& text, const std::string& default_chip) {
  std::istringstream words(text);
  std::string where;
  if (!(words >> where)) return LineSpec{};
  LineSpec spec;
  const std::size_t colon = where.rfind(':');
  spec.chip = colon == std::string::npos ? default_chip : where.substr(0, colon);
  spec.line = colon == std::string::npos ? where : where.substr(colon + 1);
  if (spec.chip.empty() || spec.line.empty()) {
    return failure(ResultCode::kValueOutOfRange, "expected %s, found '%s': no %s; see gpioinfo", kLineSpecForm,
                   text.c_str(), spec.line.empty() ? "line" : "chip, and none in lines.chip");
  }
  for (std::string word; words >> word;) {
    if (const auto taken = take_option(spec, word); !taken) return std::unexpected(taken.error());
  }
  return spec;
}

std::optional<unsigned> line_number(const LineSpec& spec) {
  unsigned number = 0;
  const char* end = spec.line.data() + spec.line.size();
  const auto parsed = std::from_chars(spec.line.data(), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  return number;
}

}  // namespace beltpick::capture
