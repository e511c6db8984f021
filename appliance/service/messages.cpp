#include "service/messages.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "service/forms.hpp"

namespace beltpick::service {
namespace {

constexpr int kBusy_s = 2;  // what a client does well to wait for another's upload

}  // namespace

unsigned http_status(ResultCode code) {
  switch (code) {
    case ResultCode::kOk:
      return 200;
    case ResultCode::kRequestMalformed:
      return 400;
    case ResultCode::kNotAuthorized:
      return 401;
    case ResultCode::kRoleTooLow:
      return 403;
    case ResultCode::kRouteUnknown:
    case ResultCode::kFileNotFound:
    case ResultCode::kNothingFound:
      return 404;
    case ResultCode::kMethodNotAllowed:
      return 405;
    case ResultCode::kUsage:
    case ResultCode::kItemInUse:
      return 409;
    case ResultCode::kLengthRequired:
      return 411;
    case ResultCode::kVersionChanged:
      return 412;
    case ResultCode::kBodyTooLarge:
      return 413;
    case ResultCode::kMediaTypeWrong:
      return 415;
    case ResultCode::kTooManyRequests:
      return 429;
    case ResultCode::kFileNotWritten:
    case ResultCode::kFileUnreadable:
    case ResultCode::kInternal:
      return 500;
    case ResultCode::kServiceBusy:
      return 503;
    case ResultCode::kDiskFull:
      return 507;
    default:
      return 422;  // understood, but not what the cell can work with
  }
}

ApiReply refusal(const Error& error, int retry_after_s) {
  ApiReply reply;
  reply.code = error.code;
  reply.status = http_status(error.code);
  contract_io::Json json = code_json(error.code);
  json["detail"] = contract_io::one_line(error.detail);
  if (reply.status == 503 && retry_after_s == 0) retry_after_s = kBusy_s;
  if (retry_after_s > 0) json["retry_after_s"] = retry_after_s;
  reply.retry_after_s = retry_after_s;
  reply.body = contract_io::json_text(json);
  return reply;
}

}  // namespace beltpick::service
