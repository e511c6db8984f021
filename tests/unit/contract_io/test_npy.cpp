#include <catch2/catch.hpp>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/npy_io.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

std::string npy(const std::string& dictionary, const std::string& data) {
  return std::string("\x93NUMPY\x01\x00", 8) + little(dictionary.size(), 2) + dictionary + data;
}

}  // namespace

TEST_CASE("Arrays read back as written", "[npy]") {
  const TempFolder folder;
  const std::vector<float> floats{1.5F, -2.0F, 3.25F, 0.0F, 5.0F, 6.0F};
  REQUIRE(write_npy<float>(folder / "f.npy", floats, {2, 3}));
  const auto back = read_npy<float>(folder / "f.npy", {-1, 3});
  REQUIRE(back);
  CHECK(back->shape == std::vector<int>{2, 3});
  CHECK(back->values == floats);

  const std::vector<std::uint16_t> labels{0, 65535};
  REQUIRE(write_npy<std::uint16_t>(folder / "u.npy", labels, {2}));
  CHECK(read_npy<std::uint16_t>(folder / "u.npy", {-1})->values == labels);
  const std::vector<std::uint8_t> bytes{7};
  REQUIRE(write_npy<std::uint8_t>(folder / "b.npy", bytes, {1, 1}));
  CHECK(read_npy<std::uint8_t>(folder / "b.npy", {-1, -1})->values == bytes);
}

TEST_CASE("The header is NumPy's own, aligned to 64 bytes", "[npy]") {
  const TempFolder folder;
  const std::vector<float> values(6);
  REQUIRE(write_npy<float>(folder / "f.npy", values, {1, 2, 3}));
  const std::string bytes = file_bytes(folder / "f.npy");
  CHECK(bytes.size() % 64 == 24);
  CHECK(bytes.find("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3, ), }") == 10);
}

TEST_CASE("Headers of versions 1 and 2, any spacing and quotes, are read", "[npy]") {
  const std::string data(8, '\0');
  CHECK(decode_npy<float>(npy("{\"shape\":(2,),\"fortran_order\" : False,'descr':'<f4'}\n", data), "a", {2}));
  const std::string dictionary = "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }";
  CHECK(decode_npy<float>(std::string("\x93NUMPY\x02\x00", 8) + little(dictionary.size(), 4) + dictionary + data, "a",
                          {2}));
}

TEST_CASE("Other dtypes, orders and shapes are refused by name", "[npy]") {
  const std::string data(24, '\0');
  const auto refused = [&](const std::string& dictionary, std::string_view words) {
    const auto array = decode_npy<float>(npy(dictionary, data), "x.npy", {-1, 3});
    REQUIRE_FALSE(array);
    CHECK(array.error().code == ResultCode::kFormatInvalid);
    CHECK(mentions(array.error(), "x.npy"));
    INFO(array.error().text());
    CHECK(mentions(array.error(), words));
  };
  refused("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }", "expected float32 ('<f4'), found '<f8'");
  refused("{'descr': '>f4', 'fortran_order': False, 'shape': (2, 3), }", "found '>f4'");
  refused("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (2, 3), }", "descr");
  refused("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }", "ascontiguousarray");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (6,), }", "expected (any, 3), found (6)");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }", "found (3, 2)");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }", "found (0, 3)");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (9, 3), }", "expected 108 bytes");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3), }", "expected 12 bytes");
  refused("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999, 3), }", "shape");
  refused("{'descr': '<f4', 'fortran_order': False}", "shape");
}

TEST_CASE("Text, an empty file and a cut header are no arrays", "[npy]") {
  for (const std::string& bytes : {std::string("hello"), std::string(), std::string("\x93NUMPY\x01\x00\xff\xff", 10),
                                   std::string("\x93NUMPY", 6), std::string("\x93NUMPY\x09\x00\x00\x00", 10)}) {
    const auto array = decode_npy<float>(bytes, "x.npy", {-1});
    REQUIRE_FALSE(array);
    CHECK(is_one_line(array.error()));
  }
}
