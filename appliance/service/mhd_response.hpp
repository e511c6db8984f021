// An answer as libmicrohttpd sends it: body, and the headers that every answer has.
#pragma once

#include "service/messages.hpp"

struct MHD_Response;

namespace beltpick::service {

// The body is not copied: `reply` outlives the response. Null where there is no memory.
MHD_Response* response_of(const ApiReply& reply);

}  // namespace beltpick::service
