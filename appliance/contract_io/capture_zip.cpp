// A capture in a .zip, by way of libzip: the whole archive is never unpacked.
#include <zip.h>

#include <optional>

#include "contract/result_codes.hpp"
#include "contract_io/capture_source.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::contract_io {
namespace {

constexpr std::size_t kMaxEntryBytes = std::size_t{1} << 30U;

struct CloseArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseEntry {
  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};
using Archive = std::unique_ptr<zip_t, CloseArchive>;
using Entry = std::unique_ptr<zip_file_t, CloseEntry>;

class ZipSource : public CaptureSource {
 public:
  ZipSource(std::filesystem::path path, Archive archive, std::string prefix)
      : path_(std::move(path)), archive_(std::move(archive)), prefix_(std::move(prefix)) {}

  [[nodiscard]] bool has(const std::string& file) const override {
    return zip_name_locate(archive_.get(), (prefix_ + file).c_str(), 0) >= 0;
  }

  Result<std::string> read(const std::string& file) override {
    zip_stat_t status;
    zip_stat_init(&status);
    const std::string entry_name = prefix_ + file;
    if (zip_stat(archive_.get(), entry_name.c_str(), 0, &status) != 0) return broken(file, "no such file");
    if ((status.valid & ZIP_STAT_SIZE) == 0 || status.size > kMaxEntryBytes)
      return broken(file, "one that is too large");
    const Entry entry(zip_fopen(archive_.get(), entry_name.c_str(), 0));
    if (!entry) return broken(file, zip_strerror(archive_.get()));
    return read_all(*entry, status.size, file);
  }

  [[nodiscard]] std::string name_of(const std::string& file) const override {
    return one_line(path_.string() + ":" + prefix_ + file);
  }
  [[nodiscard]] std::string id() const override { return one_line(path_.stem().string()); }

 private:
  // The declared size is not believed before the bytes are there.
  [[nodiscard]] Result<std::string> read_all(zip_file_t& entry, std::size_t size, const std::string& file) const {
    std::string bytes;
    char block[1U << 16U];
    zip_int64_t got = 0;
    while ((got = zip_fread(&entry, block, sizeof block)) > 0) {
      bytes.append(block, static_cast<std::size_t>(got));
      if (bytes.size() > size) return broken(file, "more bytes than it declares");
    }
    if (got < 0) return broken(file, zip_error_strerror(zip_file_get_error(&entry)));
    return bytes;
  }

  [[nodiscard]] std::unexpected<Error> broken(const std::string& file, const char* found) const {
    return failure(ResultCode::kFileUnreadable, "%s: expected a readable file, found %s; make the archive again",
                   name_of(file).c_str(), found);
  }

  std::filesystem::path path_;
  Archive archive_;
  std::string prefix_;
};

// "" or "folder/": where capture.json stands, if it stands at the root or in just one folder.
std::optional<std::string> find_prefix(zip_t* archive) {
  const std::string wanted = kCaptureFile;
  if (zip_name_locate(archive, kCaptureFile, 0) >= 0) return "";
  std::optional<std::string> prefix;
  const zip_int64_t entries = zip_get_num_entries(archive, 0);
  for (zip_int64_t i = 0; i < entries; ++i) {
    const char* raw = zip_get_name(archive, static_cast<zip_uint64_t>(i), 0);
    const std::string entry = raw == nullptr ? "" : raw;
    const std::size_t slash = entry.find('/');
    if (slash == std::string::npos || entry.substr(slash + 1) != wanted || entry.starts_with("__MACOSX")) continue;
    if (prefix) return std::nullopt;
    prefix = entry.substr(0, slash + 1);
  }
  return prefix;
}

}  // namespace

Result<std::unique_ptr<CaptureSource>> open_zip_source(const std::filesystem::path& path) {
  const std::string name = one_line(path.string());
  int code = 0;
  Archive archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (!archive) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    auto failed = failure(ResultCode::kFileUnreadable, "%s: expected a readable zip archive, found: %s; make it again",
                          name.c_str(), zip_error_strerror(&error));
    zip_error_fini(&error);
    return failed;
  }
  const auto prefix = find_prefix(archive.get());
  if (!prefix) {
    return failure(
        ResultCode::kFileNotFound,
        "%s: expected capture.json at the archive's root or in its one folder, found none or several; zip one "
        "capture folder",
        name.c_str());
  }
  return std::make_unique<ZipSource>(path, std::move(archive), *prefix);
}

}  // namespace beltpick::contract_io
