// The API's handlers of who may ask it.
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"
#include "service/api.hpp"

namespace beltpick::service {
namespace {

using contract_io::Json;

constexpr const char* kUnnamed = "commissioner";  // who enrols without a name

ApiReply made(const std::string& token, const std::string& name, Role role) {
  ApiReply reply;
  reply.status = 201;
  reply.body = contract_io::json_text(Json{{"token", token}, {"name", name}, {"role", role_name(role)}});
  return reply;
}

}  // namespace

ApiReply Api::enrol(const ApiRequest& request) {
  contract_io::Warnings warnings;
  contract_io::JsonDocument document(request.body, "request", warnings);
  contract_io::JsonObject message = document.message();
  const std::string one_time_token = message.text("token");
  const std::string name = message.text("name", kUnnamed);
  if (document.failed()) return refusal(document.error().error());
  const auto token = tokens_.enrol(one_time_token, name);
  return token ? made(*token, name, Role::kCommissioner) : refusal(token.error());
}

ApiReply Api::list_tokens() {
  Json list = Json::array();
  for (const TokenBook::Entry& entry : tokens_.entries()) {
    list.push_back({{"name", entry.name}, {"role", role_name(entry.role)}, {"time", entry.time_utc}});
  }
  ApiReply reply;
  reply.body = contract_io::json_text(Json{{"tokens", list}});
  return reply;
}

ApiReply Api::make_token(const ApiRequest& request) {
  contract_io::Warnings warnings;
  contract_io::JsonDocument document(request.body, "request", warnings);
  contract_io::JsonObject message = document.message();
  const std::string name = message.text("name");
  const int role =
      message.choice("role", {role_name(Role::kViewer), role_name(Role::kOperator), role_name(Role::kCommissioner)});
  if (document.failed()) return refusal(document.error().error());
  const Role wanted = static_cast<Role>(role + static_cast<int>(Role::kViewer));
  const auto token = tokens_.make(name, wanted);
  return token ? made(*token, name, wanted) : refusal(token.error());
}

ApiReply Api::revoke_token(const ApiRequest& request) {
  const std::string name(request.names.name);
  if (const auto gone = tokens_.revoke(name); !gone) return refusal(gone.error());
  ApiReply reply;
  reply.body = contract_io::json_text(Json{{"name", name}});
  return reply;
}

}  // namespace beltpick::service
