// The API's document says what the table of routes says, no more and no less, and every name it refers to is there.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "contract/api.hpp"
#include "service/openapi_document.hpp"
#include "service/router.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::service;
using nlohmann::json;

namespace {

std::string lower(std::string_view text) {
  std::string out;
  for (const char c : text) out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// Every "$ref" below `value` resolves within `document`.
void check_references(const json& value, const json& document) {
  if (value.is_object() && value.contains("$ref")) {
    const std::string reference = value["$ref"];
    INFO(reference);
    REQUIRE(reference.starts_with("#/"));
    CHECK(document.contains(json::json_pointer(reference.substr(1))));
  }
  if (!value.is_structured()) return;
  for (const auto& item : value) check_references(item, document);
}

}  // namespace

TEST_CASE("the OpenAPI document describes every route, its role and its names, and no other", "[openapi]") {
  const json document = json::parse(kOpenApiDocument);
  CHECK(document["openapi"] == "3.1.0");
  std::set<std::string> described;
  for (const auto& [path, methods] : document["paths"].items()) {
    for (const auto& [method, operation] : methods.items()) described.insert(method + " " + path);
  }
  std::set<std::string> operations;
  for (const ApiRoute& route : kApiRoutes) {
    const std::string method = lower(method_name(route.method));
    const std::string path(route.path);
    INFO(method << " " << path);
    REQUIRE(described.erase(method + " " + path) == 1);
    const json& operation = document["paths"][path][method];
    CHECK(operation["summary"] == std::string(route.summary));
    CHECK(operation["x-beltpick-role"] == std::string(role_name(route.role)));
    CHECK(operation["security"].empty() == (route.role == Role::kNobody));
    CHECK(operation["responses"].contains("401") == (route.role > Role::kNobody || route.action == ApiAction::kEnrol));
    CHECK(operation["responses"].contains("403") == (route.role > Role::kViewer));
    CHECK(operation["responses"].contains("429"));
    CHECK(operations.insert(operation["operationId"]).second);
  }
  CHECK(described.empty());
  check_references(document, document);
}

TEST_CASE("what the program serves is the committed document", "[openapi]") {
  CHECK(std::string(kOpenApiDocument) == test::file_bytes(BELTPICK_SOURCE_DIR "/appliance/contract/openapi.json"));
}
