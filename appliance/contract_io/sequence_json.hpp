// The members `projector` and `frames`, which sequence.json, capture.json and a recipe with a sequence of its own
// share. Internal to contract_io.
#pragma once

#include "contract/capture.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {

Sequence read_sequence_members(JsonDocument& document, JsonObject& object);
void append_sequence(const Sequence& sequence, Json& json);

}  // namespace beltpick::contract_io
