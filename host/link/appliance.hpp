// Appliance: the calls of the API, as an enrolled user makes them. Refusals come as errors with their remedy.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/api.hpp"
#include "link/http_client.hpp"
#include "link/known_appliances.hpp"

namespace beltpick::link {

// What stands for the braces of a route's path.
struct RouteValues {
  std::string kind, name, version;
};

// Path of a route with its braces filled in.
std::string route_path(ApiAction action, const RouteValues& values = {});

// Trades the appliance's one-time token, or takes another as it is, for what this user keeps. `name` is that of the new
// token. Errors: kServiceUnreachable, kCertificateChanged, the appliance's refusal.
Result<KnownAppliance> enrol(const Address& address, const Fingerprint& fingerprint, const std::string& one_time_token,
                             const std::string& name);

class Appliance {
 public:
  explicit Appliance(KnownAppliance known);

  // The one that this user enrolled with. Errors: those of KnownAppliances.
  static Result<Appliance> at(const Address& address);

  [[nodiscard]] const KnownAppliance& known() const { return known_; }

  // A successful answer. Errors: kServiceUnreachable, kCertificateChanged, and what the appliance refused, in its
  // words.
  Result<HttpAnswer> call(ApiAction action, const RouteValues& values = {}, std::string_view body = {},
                          const Progress& progress = {});

 private:
  KnownAppliance known_;
  HttpClient client_;
};

}  // namespace beltpick::link
