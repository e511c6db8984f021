#include "service/mhd_response.hpp"

#include <microhttpd.h>

#include <string>

namespace beltpick::service {
namespace {

void add_header(MHD_Response* response, const char* name, const std::string& value) {
  if (!value.empty()) MHD_add_response_header(response, name, value.c_str());
}

}  // namespace

MHD_Response* response_of(const ApiReply& reply) {
  MHD_Response* response =
      MHD_create_response_from_buffer(reply.body.size(), const_cast<char*>(reply.body.data()), MHD_RESPMEM_PERSISTENT);
  if (response == nullptr) return nullptr;
  add_header(response, "Content-Type", reply.content_type);
  add_header(response, "Cache-Control", "no-store");
  add_header(response, "X-Content-Type-Options", "nosniff");
  add_header(response, "X-Frame-Options", "DENY");
  add_header(response, "Referrer-Policy", "no-referrer");
  add_header(response, "Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
  add_header(response, "Allow", reply.allow);
  if (!reply.etag.empty()) add_header(response, "ETag", "\"" + reply.etag + "\"");
  if (reply.version > 0) add_header(response, kVersionHeader.data(), std::to_string(reply.version));
  if (reply.retry_after_s > 0) add_header(response, "Retry-After", std::to_string(reply.retry_after_s));
  if (reply.status == 401) add_header(response, "WWW-Authenticate", "Bearer");
  return response;
}

}  // namespace beltpick::service
