#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {
namespace {

constexpr std::size_t kLine = 150;  // characters that still fit on one line

std::string flat(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

void write(const Json& value, std::size_t indent, std::string& out) {
  const std::string line = value.is_structured() ? flat(value) : std::string();
  if (!value.is_structured() || line.size() + indent <= kLine) {
    out += value.is_structured() ? line : flat(value);
    return;
  }
  const std::string margin(indent + 2, ' ');
  out += value.is_object() ? "{\n" : "[\n";
  bool first = true;
  for (const auto& item : value.items()) {
    if (!first) out += ",\n";
    first = false;
    out += margin;
    if (value.is_object()) out += flat(Json(item.key())) + ": ";
    write(item.value(), indent + 2, out);
  }
  out += "\n" + std::string(indent, ' ') + (value.is_object() ? "}" : "]");
}

}  // namespace

std::string json_text(const Json& value) {
  std::string out;
  write(value, 0, out);
  return out + "\n";
}

}  // namespace beltpick::contract_io
