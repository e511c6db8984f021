// seal: the build's last step of a firmware: puts its record (length, version, CRC) into its hex file. Runs on the PC.
//   seal <hex file> <mcu> <major.minor.patch>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "boot/seal.hpp"

namespace {

int refuse(const std::string& what) {
  std::fprintf(stderr, "seal: %s\n", what.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace beltpick::boot;
  if (argc != 4) return refuse("expected <hex file> <mcu> <major.minor.patch>");
  const ChipLayout* chip = find_chip(std::string(argv[2]));
  if (chip == nullptr) return refuse(std::string(argv[2]) + ": expected a microcontroller of ours");
  Version version{};
  char more = 0;
  if (std::sscanf(argv[3], "%hhu.%hhu.%hhu%c", &version.major, &version.minor, &version.patch, &more) != 3) {
    return refuse(std::string(argv[3]) + ": expected a version of three numbers up to 255");
  }
  std::ifstream in(argv[1], std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  in.close();
  FlashImage image;
  const std::string unread = read_hex(text, image);
  if (!unread.empty()) return refuse(argv[1] + (": " + unread));
  const std::string unsealed = seal(image, *chip, version);
  if (!unsealed.empty()) return refuse(argv[1] + (": " + unsealed));
  std::ofstream out(argv[1], std::ios::binary);
  out << hex_text(image);
  return out.flush() ? 0 : refuse(std::string(argv[1]) + ": cannot be written");
}
