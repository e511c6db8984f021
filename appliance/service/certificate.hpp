// The service's certificate: self-signed, made once at the first start, pinned by whoever enrols.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "service/folder.hpp"

namespace beltpick::service {

struct Certificate {
  std::string key_pem;
  std::string certificate_pem;
  std::string fingerprint;  // "sha256:" and SHA-256 of the public key (DER) in hex, as `beltpick enrol` shows it
};

// Reads <state>/tls/key.pem and certificate.pem; where neither is there, makes them: EC P-256, ten years, for this
// host's name, localhost and its addresses. Says in `notes` what was made, and when it ends within 90 days. One that is
// there is never replaced: clients have pinned its key. The fingerprint is written to <state>/tls/fingerprint. Errors:
// kFileUnreadable, kFormatInvalid (the two do not belong together), kFileNotWritten.
Result<Certificate> open_certificate(const Folder& state, std::vector<std::string>& notes);

}  // namespace beltpick::service
