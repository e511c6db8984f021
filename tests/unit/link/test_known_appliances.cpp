#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "link/known_appliances.hpp"
#include "link/private_file.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::test;
using link::KnownAppliances;

namespace {

const link::Address kAddress{"cell4", 8443};

link::KnownAppliance sample() {
  link::KnownAppliance known{kAddress, {}, "secret", "anna-laptop", "commissioner", "2026-11-22T07:00:00Z"};
  known.fingerprint.sha256.fill(0xa5);
  return known;
}

unsigned mode_of(const std::filesystem::path& path) {
  struct stat status {};
  REQUIRE(stat(path.c_str(), &status) == 0);
  return status.st_mode & 07777U;
}

// A folder with the sample kept in it.
struct Kept {
  TempFolder folder;
  KnownAppliances appliances{folder / "config" / "appliances"};
  std::filesystem::path file = appliances.file(kAddress);
  Kept() { REQUIRE(appliances.keep(sample())); }
};

}  // namespace

TEST_CASE("What was kept is found again, and nobody else can read it", "[link]") {
  const mode_t before = umask(0);
  const Kept kept;
  umask(before);
  CHECK(mode_of(kept.file) == 0600);
  CHECK(mode_of(kept.file.parent_path()) == 0700);
  CHECK(mode_of(kept.file.parent_path().parent_path()) == 0700);
  const auto found = kept.appliances.find(kAddress);
  REQUIRE(found);
  CHECK(found->fingerprint == sample().fingerprint);
  CHECK(found->token == "secret");
  CHECK(found->name == "anna-laptop");
  CHECK(found->role == "commissioner");
  CHECK(found->enrolled_utc == "2026-11-22T07:00:00Z");
}

TEST_CASE("Keeping again replaces, and leaves nothing else behind", "[link]") {
  const Kept kept;
  auto other = sample();
  other.token = "another";
  REQUIRE(kept.appliances.keep(other));
  CHECK(kept.appliances.find(kAddress)->token == "another");
  const std::filesystem::directory_iterator entries(kept.file.parent_path());
  CHECK(std::distance(begin(entries), end(entries)) == 1);
}

TEST_CASE("An appliance is known by host and port", "[link]") {
  const Kept kept;
  const auto found = kept.appliances.find({"cell4", 8444});
  REQUIRE_FALSE(found);
  CHECK(found.error().code == ResultCode::kNotEnrolled);
  CHECK(found.error().text().find("beltpick enrol --to cell4:8444") != std::string_view::npos);
}

TEST_CASE("A file that others may touch is refused with the remedy", "[link]") {
  const Kept kept;
  for (const mode_t mode : {0640, 0604, 0620, 0602, 0610, 0666}) {
    REQUIRE(chmod(kept.file.c_str(), mode) == 0);
    const auto found = kept.appliances.find(kAddress);
    INFO(mode);
    REQUIRE_FALSE(found);
    CHECK(found.error().code == ResultCode::kFileUnreadable);
    CHECK(found.error().text().find("chmod 600") != std::string_view::npos);
    CHECK(found.error().text().find("secret") == std::string_view::npos);
  }
  REQUIRE(chmod(kept.file.c_str(), 0400) == 0);
  CHECK(kept.appliances.find(kAddress));
}

TEST_CASE("A folder that others may write to is refused: they could put another file there", "[link]") {
  const Kept kept;
  for (const mode_t mode : {0720, 0702, 0777}) {
    REQUIRE(chmod(kept.file.parent_path().c_str(), mode) == 0);
    const auto found = kept.appliances.find(kAddress);
    REQUIRE_FALSE(found);
    CHECK(found.error().text().find("chmod 700") != std::string_view::npos);
  }
}

TEST_CASE("A damaged file is named, not trusted", "[link]") {
  const Kept kept;
  const std::string whole = file_bytes(kept.file);
  for (std::size_t size = 0; size + 2 < whole.size(); size += 5) {
    REQUIRE(link::write_private_file(kept.file, whole.substr(0, size)));
    const auto found = kept.appliances.find(kAddress);
    REQUIRE_FALSE(found);
    CHECK(found.error().code != ResultCode::kNotEnrolled);
    CHECK(found.error().text().find("cell4_8443.json") != std::string_view::npos);
  }
}

TEST_CASE("A place that cannot be written is an error, and nothing is half-written", "[link]") {
  const TempFolder folder;
  (void)folder.file("config", "a file where a folder should be");
  const auto kept = KnownAppliances(folder / "config" / "appliances").keep(sample());
  REQUIRE_FALSE(kept);
  CHECK(kept.error().code == ResultCode::kFileNotWritten);
}
