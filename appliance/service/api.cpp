#include "service/api.hpp"

#include <exception>

#include "contract/result_codes.hpp"

namespace beltpick::service {

bool Api::is_slow(ApiAction action) {
  return action == ApiAction::kUpload || action == ApiAction::kRemove || action == ApiAction::kRollback ||
         action == ApiAction::kRunSelfTest;
}

ApiReply Api::answer(const ApiRequest& request) {
  try {
    return dispatch(request);
  } catch (const std::exception& problem) {
    return refusal(
        failure(ResultCode::kInternal, "the service: expected to answer, found: %s", problem.what()).error());
  }
}

ApiReply Api::dispatch(const ApiRequest& request) {
  switch (request.action) {
    case ApiAction::kHealth:
      return health();
    case ApiAction::kOpenApi:
      return open_api();
    case ApiAction::kEnrol:
      return enrol(request);
    case ApiAction::kStatus:
      return status(request);
    case ApiAction::kListResultCodes:
      return list_result_codes();
    case ApiAction::kSelfTest:
      return self_test();
    case ApiAction::kRunSelfTest:
      return run_self_test();
    case ApiAction::kListItems:
      return list_items();
    case ApiAction::kDownload:
      return download(request, false);
    case ApiAction::kUpload:
      return upload(request);
    case ApiAction::kRemove:
      return remove(request);
    case ApiAction::kListVersions:
      return list_versions(request);
    case ApiAction::kDownloadVersion:
      return download(request, true);
    case ApiAction::kRollback:
      return roll_back(request);
    case ApiAction::kListTokens:
      return list_tokens();
    case ApiAction::kMakeToken:
      return make_token(request);
    case ApiAction::kRevokeToken:
      return revoke_token(request);
  }
  return refusal(failure(ResultCode::kInternal, "the service: expected an action, found none").error());
}

}  // namespace beltpick::service
