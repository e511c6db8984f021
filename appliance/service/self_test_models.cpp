// The self-test's checks of what the cell works with: store, calibration, recipe, templates.
#include "contract/result_codes.hpp"
#include "service/self_test_checks.hpp"

namespace beltpick::service {

namespace {
constexpr double kOldDays = 90.0;
}

Check check_store(const StoreFound& store) {
  constexpr const char* kName = "store";
  if (!store.configured) return skipped(kName, "none is configured: the files of [model] are used as they are");
  if (store.problem.code != ResultCode::kOk) return failed_by(kName, store.problem);
  if (store.damaged.empty()) return good(kName, "%d item%s", store.items, store.items == 1 ? "" : "s");
  return not_good(Verdict::kFailed, kName, store.damaged,
                  "the newest version was damaged on the disk; it was set aside",
                  "upload it again or roll back, and check the disk; the item is not used until then");
}

Check check_calibration(const CalibrationFound& calibration) {
  constexpr const char* kName = "calibration";
  if (!calibration.there) {
    return not_good(Verdict::kFailed, kName, "none", "this cell was not calibrated yet",
                    "beltpick calibrate, then beltpick upload calibration calibration.json --to HOST");
  }
  if (calibration.problem.code != ResultCode::kOk) return failed_by(kName, calibration.problem);
  const std::string id = calibration.id.empty() ? "without an id" : "'" + calibration.id + "'";
  if (!calibration.age_days) return good(kName, "%s", id.c_str());
  const std::string found = text("%s, stored %.0f days ago", id.c_str(), *calibration.age_days);
  if (*calibration.age_days <= kOldDays) return good(kName, "%s", found.c_str());
  return not_good(Verdict::kWarning, kName, found, "cameras and projectors move a little with time and temperature",
                  "check it on a known part, or calibrate anew");
}

Check check_models(const ModelsFound& models) {
  constexpr const char* kName = "models";
  if (models.problem.code != ResultCode::kOk) return failed_by(kName, models.problem);
  return good(kName, "recipe %u '%s': %d frames, %d template%s", unsigned{models.recipe}, models.recipe_name.c_str(),
              models.frames, models.templates, models.templates == 1 ? "" : "s");
}

}  // namespace beltpick::service
