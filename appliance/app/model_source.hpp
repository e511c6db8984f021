// ModelSource: where calibration, cell, templates and recipes come from: the files that the configuration names, or the
// appliance's store. What somebody wants to upload is laid over the store and read in the same way.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/settings.hpp"
#include "base/result.hpp"
#include "contract/recipe.hpp"
#include "service/store.hpp"

namespace beltpick::app {

// The content of one file or item.
struct ModelDocument {
  std::string bytes;
  std::string source;         // how messages call it
  std::string name;           // of a template: how results call the part
  std::uint32_t version = 0;  // 0: not known, it may have changed at any time
};

class ModelSource {
 public:
  virtual ~ModelSource() = default;

  // Errors: kNoCalibration, kNoTemplate, kRecipeUnknown where there is none; those of reading a file. A cell that is
  // not there is an empty document: the cell does without.
  [[nodiscard]] virtual Result<ModelDocument> get(const service::ItemId& id) const = 0;
  // The names of the recipes there are.
  [[nodiscard]] virtual std::vector<std::string> recipes() const = 0;
  // Reads the text of one of them.
  virtual Result<Recipe> parse(const ModelDocument& recipe, std::vector<std::string>& warnings) const = 0;
};

// The files of `[model]`; the names of templates and recipes are their paths.
class FileSource : public ModelSource {
 public:
  explicit FileSource(const Settings& settings) : settings_(settings) {}

  [[nodiscard]] Result<ModelDocument> get(const service::ItemId& id) const override;
  [[nodiscard]] std::vector<std::string> recipes() const override { return settings_.recipes; }
  Result<Recipe> parse(const ModelDocument& recipe, std::vector<std::string>& warnings) const override;

 private:
  const Settings& settings_;
};

// An item whose newest version was damaged on the disk is not there, though an older one is: with the calibration of
// before the camera was moved every pose would be wrong. Error: kChecksumWrong, until it is uploaded or rolled back.
class StoreSource : public ModelSource {
 public:
  explicit StoreSource(const service::Store& store) : store_(store) {}

  [[nodiscard]] Result<ModelDocument> get(const service::ItemId& id) const override;
  [[nodiscard]] std::vector<std::string> recipes() const override;
  Result<Recipe> parse(const ModelDocument& recipe, std::vector<std::string>& warnings) const override;

 private:
  const service::Store& store_;
};

// Another source with some of its items replaced or added.
class OverlaidSource : public ModelSource {
 public:
  explicit OverlaidSource(const ModelSource& below) : below_(below) {}
  void lay(const service::ItemId& id, std::string_view bytes) { items_[id] = bytes; }

  [[nodiscard]] Result<ModelDocument> get(const service::ItemId& id) const override;
  [[nodiscard]] std::vector<std::string> recipes() const override;
  Result<Recipe> parse(const ModelDocument& recipe, std::vector<std::string>& warnings) const override {
    return below_.parse(recipe, warnings);
  }

 private:
  const ModelSource& below_;
  std::map<service::ItemId, std::string> items_;
};

// How messages call an item: "calibration", "template 'knuckle'".
std::string item_text(const service::ItemId& id);

// The calibration's and the cell's one item; of a template or recipe that of the name.
service::ItemId item_id(ItemKind kind, const std::string& name = "");

}  // namespace beltpick::app
