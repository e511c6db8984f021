// beltpick download: an item of an appliance to a file, the current version or an older one.
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

struct DownloadCommand {
  ItemWords item;
  std::string to;
  std::string out;
  unsigned version = 0;  // 0: the current one
};

Result<void> run(const DownloadCommand& command, Session& session) {
  auto item = item_of(command.item);
  if (!item) return std::unexpected(item.error());
  auto appliance = open_appliance(command.to);
  if (!appliance) return std::unexpected(appliance.error());
  if (command.version > 0) item->version = std::to_string(command.version);
  Progress bar("download", 100, session.json);
  const auto answer = appliance->call(command.version > 0 ? ApiAction::kDownloadVersion : ApiAction::kDownload, *item,
                                      {}, [&](std::size_t done, std::size_t total) {
                                        if (total > 0) bar.show(static_cast<int>(100 * done / total));
                                      });
  if (!answer) return std::unexpected(answer.error());
  if (auto written = contract_io::write_file(command.out, answer->body); !written) return written;
  Json json{{"kind", item->kind},
            {"name", item->name},
            {"version", nullptr},
            {"bytes", answer->body.size()},
            {"file", command.out}};
  const Json version = Json::parse(answer->version, nullptr, false);
  if (version.is_number_unsigned()) json["version"] = version;
  session.answer(json, command.out + ": " + item_words(*item) + ", version " + answer->version + ", " +
                           std::to_string(answer->body.size()) + " bytes\n");
  return {};
}

}  // namespace

Run add_download(CLI::App& app) {
  const auto command = std::make_shared<DownloadCommand>();
  add_item(app, command->item);
  add_to(app, command->to);
  app.add_option("--out", command->out, "the file to write")->required()->type_name("FILE");
  app.add_option("--version", command->version, "an older one; 'beltpick items KIND NAME' lists them")
      ->check(CLI::Range(1U, 4'000'000'000U));
  example(app,
          "  beltpick download template knuckle --to cell4.local --out knuckle.template\n"
          "  beltpick download calibration --to cell4.local --version 3 --out calibration.json");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
