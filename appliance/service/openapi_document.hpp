// The API's OpenAPI document, contract/openapi.json, as built into the program.
#pragma once

#include <string_view>

namespace beltpick::service {

extern const std::string_view kOpenApiDocument;

}  // namespace beltpick::service
