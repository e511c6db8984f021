// Everything that reads a CLOUD, given arrays that are none.
#include <catch2/catch.hpp>

#include "contract_io/npy_header.hpp"
#include "workshop.hpp"

using namespace beltpick::test;
namespace fs = std::filesystem;

namespace {

// An .npy file of `values` bytes under a header of the given dtype and shape.
std::string array(const std::string& dtype, std::initializer_list<int> shape, std::size_t bytes, char fill = 'B') {
  return beltpick::contract_io::npy_header_text(dtype, shape) + std::string(bytes, fill);
}

void refused(const std::string& bytes, const std::string& words) {
  const TempFolder input;
  const std::string cloud = input.file("cloud.npy", bytes).string();
  const std::string taught = (workshop() / "knuckle.template").string();
  for (const std::string command : {"segment", "primitives", "locate"}) {
    const TempFolder folder;
    std::string options = command == "primitives" ? " --json" : " --out " + (folder / "out").string();
    if (command == "locate") options += " --template " + taught;
    std::string arguments = command;
    arguments += " " + cloud + options;
    const Outcome outcome = beltpick_run(arguments);
    INFO(arguments << ": " << outcome.err);
    CHECK(outcome.exit_code == 1);
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find("cloud.npy") != std::string::npos);
    CHECK(outcome.err.find(words) != std::string::npos);
    CHECK(fs::is_empty(folder.path()));
  }
}

}  // namespace

TEST_CASE("Arrays of another type, shape or length are no cloud", "[bad_input]") {
  refused("hello", "another format");
  refused("", "an empty file");
  refused(array("<f8", {20, 30, 3}, 20 * 30 * 24), "expected float32 ('<f4'), found '<f8'");
  refused(array("<f4", {600, 3}, 600 * 12), "found (600, 3)");
  refused(array("<f4", {20, 30, 4}, 20 * 30 * 16), "found (20, 30, 4)");
  refused(array("<f4", {20, 30, 3}, 20 * 30 * 12 - 1), "data: expected 7200 bytes");
}

TEST_CASE("Clouds with nothing in them, or nothing a camera can see, say so", "[bad_input]") {
  refused(array("<f4", {20, 30, 3}, 20 * 30 * 12, '\0'), "[TOO_FEW_POINTS]");
  refused(array("<f4", {20, 30, 3}, 20 * 30 * 12, '\xff'), "[TOO_FEW_POINTS]");  // every value a NaN
  refused(array("<f4", {2, 3, 3}, 2 * 3 * 12), "[TOO_FEW_POINTS]");
  refused(array("<f4", {100, 100, 3}, 100 * 100 * 12), "optical centre");  // the same point everywhere
}
