// beltpick upload: files to an appliance, each a new version of its item.
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "stored_twins.hpp"
#include "upload_item.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct UploadCommand {
  std::string kind;
  std::vector<std::string> files;
  std::string to;
  std::string name;
  bool no_compare = false;
};

Result<std::vector<UploadItem>> prepare(const UploadCommand& command) {
  const ItemKind kind = *find_item_kind(command.kind);
  if (item_kind(kind).single && !command.name.empty()) {
    return failure(ResultCode::kUsage, "--name: expected none for a %s: there is one only", command.kind.c_str());
  }
  if (command.files.size() > 1 && (item_kind(kind).single || !command.name.empty())) {
    return failure(ResultCode::kUsage, "expected one %s file%s, found %zu", command.kind.c_str(),
                   command.name.empty() ? "" : " with --name", command.files.size());
  }
  std::vector<UploadItem> items;
  for (const std::string& file : command.files) {
    auto item = prepare_upload(kind, file, command.name);
    if (!item) return std::unexpected(item.error());
    items.push_back(std::move(*item));
  }
  return items;
}

Result<Json> send(link::Appliance& appliance, const UploadItem& item, Session& session) {
  Progress bar("upload " + item.id.name, 100, session.json);
  const auto answer = appliance.call(ApiAction::kUpload, item.id, item.bytes, [&](std::size_t done, std::size_t total) {
    if (total > 0) bar.show(static_cast<int>(100 * done / total));
  });
  if (!answer) return std::unexpected(answer.error());
  const Json version = Json::parse(answer->body, nullptr, false);
  Json json{{"file", item.file}, {"kind", item.id.kind}, {"name", item.id.name}};
  if (version.is_object()) json.update(version);
  return json;
}

// The upload is taken, whatever comes of this.
void warn_of_twins(link::Appliance& appliance, const UploadItem& item, Json& upload, Session& session) {
  const auto twins = stored_twins(appliance, item, session);
  Json warnings = list_at(upload, "/warnings");
  if (!twins) {
    warnings.push_back("not compared with the templates kept there: " + std::string(twins.error().detail));
  } else {
    for (const std::string& line : *twins) warnings.push_back(line);
  }
  upload["warnings"] = warnings;
}

void tell(const Json& uploads, Session& session) {
  std::string text;
  for (const Json& upload : uploads) {
    contract_io::Warnings warnings;
    for (const Json& warning : list_at(upload, "/warnings")) warnings.push_back(words_at(warning, ""));
    session.warn(warnings);
    text +=
        item_words({words_at(upload, "/kind"), words_at(upload, "/name"), {}}) + ": " + version_words(upload) + "\n";
  }
  session.answer({{"uploads", uploads}}, text);
}

Result<void> run(const UploadCommand& command, Session& session) {
  const auto items = prepare(command);
  if (!items) return std::unexpected(items.error());
  auto appliance = open_appliance(command.to);
  if (!appliance) return std::unexpected(appliance.error());
  Json uploads = Json::array();
  for (const UploadItem& item : *items) {
    auto upload = send(*appliance, item, session);
    if (!upload) {
      if (!uploads.empty()) tell(uploads, session);  // these are taken, whatever became of the rest
      return std::unexpected(upload.error());
    }
    if (item.id.kind == item_kind(ItemKind::kTemplate).name && !command.no_compare) {
      warn_of_twins(*appliance, item, *upload, session);
    }
    uploads.push_back(std::move(*upload));
  }
  tell(uploads, session);
  return {};
}

}  // namespace

Run add_upload(CLI::App& app) {
  const auto command = std::make_shared<UploadCommand>();
  add_kind(app, command->kind);
  app.add_option("files", command->files, "the files; all are judged before the first is sent")
      ->required()
      ->type_name("FILE");
  add_to(app, command->to);
  app.add_option("--name", command->name, "of the template or recipe there (default: the file's, without its ending)")
      ->type_name("NAME");
  app.add_flag("--no-compare", command->no_compare,
               "do not compare templates with those kept there, which takes seconds for each: parts that look alike "
               "are warned of");
  example(app,
          "  beltpick upload calibration calibration.json --to cell4.local\n"
          "  beltpick upload template knuckle.template bracket.template --to cell4.local\n"
          "  beltpick upload recipe recipe.json --name knuckles --to cell4.local");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
