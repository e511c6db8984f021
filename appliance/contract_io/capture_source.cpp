#include "contract_io/capture_source.hpp"

#include <fstream>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::contract_io {
namespace {

namespace fs = std::filesystem;

class FolderSource : public CaptureSource {
 public:
  FolderSource(fs::path folder, std::string header) : folder_(std::move(folder)), header_(std::move(header)) {}

  [[nodiscard]] bool has(const std::string& file) const override {
    std::error_code error;
    return fs::is_regular_file(path_of(file), error);
  }
  Result<std::string> read(const std::string& file) override { return read_file(path_of(file)); }
  [[nodiscard]] std::string name_of(const std::string& file) const override { return one_line(path_of(file).string()); }
  [[nodiscard]] std::string id() const override {
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(folder_, error);
    return one_line((error ? folder_ : whole).filename().string());
  }

 private:
  // The header may be called otherwise where it was named itself.
  [[nodiscard]] fs::path path_of(const std::string& file) const {
    return folder_ / (file == kCaptureFile ? header_ : file);
  }

  fs::path folder_;
  std::string header_;
};

bool starts_like_zip(const fs::path& path) {
  char magic[2]{};
  std::ifstream(path, std::ios::binary).read(magic, sizeof magic);
  return magic[0] == 'P' && magic[1] == 'K';
}

std::unexpected<Error> no_capture(const std::string& name, const char* found) {
  return failure(ResultCode::kFileNotFound,
                 "%s: expected a capture (a folder or .zip with capture.json in it), found %s; check the path",
                 name.c_str(), found);
}

}  // namespace

Result<std::unique_ptr<CaptureSource>> CaptureSource::open(const fs::path& path) {
  const std::string name = one_line(path.string());
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) {
    // Images captured of a pattern folder's frames may stand beside its sequence.json.
    for (const char* header : {kCaptureFile, "sequence.json"}) {
      if (fs::is_regular_file(path / header, error)) return std::make_unique<FolderSource>(path, header);
    }
    return no_capture(name, "a folder without capture.json");
  }
  if (!fs::exists(status)) return no_capture(name, "nothing of that name");
  if (starts_like_zip(path)) return open_zip_source(path);
  if (path.extension() == ".json") return std::make_unique<FolderSource>(path.parent_path(), path.filename().string());
  return no_capture(name, path.extension() == ".zip" ? "a file that is no zip archive" : "another kind of file");
}

}  // namespace beltpick::contract_io
