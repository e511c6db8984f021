// The API's handlers that look: health, status, result codes, self-test, the API's own document.
#include "base/utc.hpp"
#include "contract/result_codes.hpp"
#include "service/api.hpp"
#include "service/forms.hpp"
#include "service/openapi_document.hpp"
#include "service/self_test_text.hpp"

namespace beltpick::service {
namespace {

using contract_io::Json;

ApiReply json_reply(const Json& json) {
  ApiReply reply;
  reply.body = contract_io::json_text(json);
  return reply;
}

Json code_or_null(ResultCode code) { return code == ResultCode::kOk ? Json() : code_json(code); }

Json in_use_json(const std::vector<ItemInUse>& items) {
  Json list = Json::array();
  for (const ItemInUse& item : items) {
    list.push_back({{"kind", item_kind(item.id.kind).name}, {"name", item.id.name}, {"version", item.version}});
  }
  return list;
}

Json pixels_json(const PixelCounts& pixels) {
  Json json = Json::object();
  for (std::size_t state = 0; state < pixels.size(); ++state)
    json[std::string(kPixelStateNames[state])] = pixels[state];
  return json;
}

}  // namespace

ApiReply Api::health() {
  return json_reply({{"product", "beltpickd"}, {"version", BELTPICK_VERSION}, {"time", now_utc()}});
}

ApiReply Api::open_api() {
  ApiReply reply;
  reply.body = kOpenApiDocument;
  return reply;
}

ApiReply Api::status(const ApiRequest& request) {
  const CellStatus cell = cell_.status();
  Json json;
  json["state"] = cell.state;
  json["last_code"] = code_json(cell.last_code);
  json["fault"] = code_or_null(cell.fault_code);
  json["model"] = code_or_null(cell.model_code);
  json["recipe"] = {{"number", cell.recipe}, {"name", cell.recipe_name}};
  json["in_use"] = in_use_json(cell.in_use);
  json["camera"] = {{"ready", cell.camera_ready}, {"serial", cell.camera_serial}};
  json["trigger"] = {{"ready", cell.trigger_ready}};
  json["plc"] = {{"connected", cell.plc_connected}};
  json["pixels"] = pixels_json(cell.pixels);
  json["belt_nearer_mm"] = cell.belt_nearer_mm ? Json(*cell.belt_nearer_mm) : Json();
  json["counters"] = {{"cycles", cell.cycles},
                      {"captures", cell.captures},
                      {"offers", cell.offers},
                      {"picked", cell.picked},
                      {"faults", cell.faults}};
  json["uptime_s"] = cell.uptime_s;
  json["memory_mb"] = {{"budget", cell.memory_budget_mb}, {"resident", cell.memory_resident_mb}};
  json["time"] = now_utc();
  json["version"] = BELTPICK_VERSION;
  json["role"] = role_name(request.caller.role);
  return json_reply(json);
}

ApiReply Api::list_result_codes() {
  Json list = Json::array();
  for (const ResultCodeEntry& entry : kResultCodes) list.push_back(code_json(entry.code));
  return json_reply({{"result_codes", list}});
}

ApiReply Api::self_test() {
  const std::lock_guard lock(self_test_mutex_);
  ApiReply reply;
  reply.body = self_test_ ? self_test_json(*self_test_) : self_test_json_before_any();
  return reply;
}

ApiReply Api::run_self_test() {
  SelfTestReport report = cell_.self_test();
  {
    const std::lock_guard lock(self_test_mutex_);
    self_test_ = std::move(report);
  }
  return self_test();
}

}  // namespace beltpick::service
