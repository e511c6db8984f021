#include "gpio_sim.hpp"

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace vm {

namespace fs = std::filesystem;

namespace {

const fs::path kTracing = "/sys/kernel/tracing";

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  if (!(out << text << std::flush)) throw std::runtime_error("cannot write '" + text + "' to " + file.string());
}

std::string first_word(const fs::path& file) {
  std::string word;
  if (!(std::ifstream(file) >> word)) throw std::runtime_error("cannot read " + file.string());
  return word;
}

}  // namespace

GpioSim::GpioSim(const std::string& label, unsigned lines, const std::vector<LineName>& names, int hogged)
    : config_("/sys/kernel/config/gpio-sim/" + label) {
  const fs::path bank = config_ / "bank0";
  fs::create_directory(config_);
  fs::create_directory(bank);
  write(bank / "num_lines", std::to_string(lines));
  write(bank / "label", label);
  for (const auto& [number, name] : names) {
    const fs::path line = bank / ("line" + std::to_string(number));
    fs::create_directory(line);
    write(line / "name", name);
  }
  if (hogged >= 0) {
    const fs::path hog = bank / ("line" + std::to_string(hogged)) / "hog";
    fs::create_directory(hog.parent_path());
    fs::create_directory(hog);
    write(hog / "name", "kernel hog");
    write(hog / "direction", "output-low");
  }
  write(config_ / "live", "1");
  chip_ = first_word(bank / "chip_name");
  device_ = fs::path("/sys/devices/platform") / first_word(config_ / "dev_name");
  for (const auto& entry : fs::directory_iterator(device_ / "gpio"))
    first_number_ = static_cast<unsigned>(std::stoul(first_word(entry.path() / "base")));
  device_ /= chip_;
}

GpioSim::~GpioSim() {
  write(config_ / "live", "0");
  std::vector<fs::path> folders{config_};
  for (const auto& entry : fs::recursive_directory_iterator(config_)) {
    if (entry.is_directory()) folders.push_back(entry.path());
  }
  while (!folders.empty()) {  // deepest first
    std::error_code ignored;
    fs::remove(folders.back(), ignored);
    folders.pop_back();
  }
}

fs::path GpioSim::line(unsigned number) const { return device_ / ("sim_gpio" + std::to_string(number)); }

void GpioSim::pull(unsigned number, bool up) const { write(line(number) / "pull", up ? "pull-up" : "pull-down"); }

bool GpioSim::level(unsigned number) const { return first_word(line(number) / "value") == "1"; }

OutputTrace::OutputTrace(const GpioSim& sim) : first_number_(sim.first_number()) {
  write(kTracing / "tracing_on", "0");
  write(kTracing / "trace", "");
  write(kTracing / "trace_clock", "mono");
  write(kTracing / "events/gpio/gpio_value/enable", "1");
  write(kTracing / "tracing_on", "1");
}

// Lines like "  trigger-123  [000] d..1.  12.345678: gpio_value: 515 set 1".
std::vector<TracedEdge> OutputTrace::read() const {
  std::ifstream trace(kTracing / "trace");
  std::vector<TracedEdge> edges;
  std::map<unsigned, bool> levels;
  for (std::string text; std::getline(trace, text);) {
    const std::size_t event = text.find(": gpio_value: ");
    if (event == std::string::npos) continue;
    std::istringstream words(text.substr(event + 14));
    unsigned number = 0, high = 0;
    std::string verb;
    if (!(words >> number >> verb >> high) || verb != "set" || number < first_number_) continue;
    const unsigned line = number - first_number_;
    if (levels[line] == (high != 0)) continue;
    levels[line] = high != 0;
    const std::size_t stamp = text.rfind(' ', event - 1) + 1;
    edges.push_back({line, high != 0, static_cast<std::int64_t>(std::stod(text.substr(stamp, event - stamp)) * 1e6)});
  }
  return edges;
}

}  // namespace vm
