#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_writer.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;
namespace fs = std::filesystem;

TEST_CASE("Files are written whole and read back", "[file]") {
  const TempFolder folder;
  const std::string bytes("a\0b\n", 4);
  REQUIRE(write_file(folder / "x", bytes));
  CHECK(*read_file(folder / "x") == bytes);
  REQUIRE(write_file(folder / "x", "shorter"));
  CHECK(*read_file(folder / "x") == "shorter");
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);  // no temporary is left
}

TEST_CASE("Links are followed and devices never replaced", "[file]") {
  const TempFolder folder;
  const fs::path target = folder.file("target", "old");
  fs::create_symlink("target", folder / "link");
  REQUIRE(write_file(folder / "link", "new"));
  CHECK(fs::is_symlink(folder / "link"));
  CHECK(file_bytes(target) == "new");
  const fs::path pipe = folder / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(write_file(pipe, "through"));
  CHECK(fs::is_fifo(pipe));
  char got[8]{};
  CHECK(read(reader, got, sizeof got) == 7);
  close(reader);
}

TEST_CASE("A failed write leaves neither file nor temporary", "[file]") {
  const TempFolder folder;
  fs::create_directory(folder / "taken");
  const auto written = write_file(folder / "taken", "x");
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ResultCode::kFileNotWritten);
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
  CHECK_FALSE(write_file(folder / "no/such/x", "x"));
  CHECK_FALSE(make_folder(folder.file("plain", "x") / "below"));
}

TEST_CASE("A full disk is told apart from other failures to write", "[file]") {
  const auto written = write_file("/dev/full", std::string(100'000, 'x'));
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ResultCode::kDiskFull);
  CHECK(write_error_code(EDQUOT) == ResultCode::kDiskFull);
  CHECK(write_error_code(EIO) == ResultCode::kFileNotWritten);
}

TEST_CASE("Reading says what is wrong", "[file]") {
  const TempFolder folder;
  CHECK(read_file(folder / "absent").error().code == ResultCode::kFileNotFound);
  CHECK(read_file(folder.file("plain", "x") / "below").error().code == ResultCode::kFileNotFound);
  CHECK(read_file(folder.path()).error().code == ResultCode::kFileUnreadable);
  CHECK(read_file(folder.file("big", "12345"), 4).error().code == ResultCode::kFileUnreadable);
  const Error odd = read_file(folder / "a\nb").error();
  CHECK(is_one_line(odd));
}

TEST_CASE("JSON keeps short things on a line and has no NaN", "[file]") {
  Json rows = Json::array();
  for (int i = 0; i < 30; ++i) rows.push_back({i, i, i});
  const std::string text = json_text({{"short", {1, 2, 3}}, {"nan", std::nan("")}, {"rows", rows}});
  CHECK(text.find("\n  \"short\": [1,2,3],\n") != std::string::npos);
  CHECK(text.find("\"nan\": null") != std::string::npos);
  CHECK(text.find("\n    [29,29,29]\n") != std::string::npos);
  CHECK(text.back() == '\n');
}
