#include "bench/pose/options.hpp"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace beltpick::bench {
namespace {

template <class T>
T number(const std::string& name, const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw std::runtime_error(name + ": expected a number, found '" + text + "'");
  return value;
}

std::vector<std::string> list(const std::string& text) {
  std::vector<std::string> items;
  std::stringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) items.push_back(item);
  return items;
}

void take(Options& options, const std::string& name, const std::string& value) {
  if (name == "--seed") {
    options.seed = number<std::uint64_t>(name, value);
  } else if (name == "--scenes") {
    options.scenes = number<int>(name, value);
  } else if (name == "--first") {
    options.first_scene = number<int>(name, value);
  } else if (name == "--stride") {
    options.stride = number<int>(name, value);
  } else if (name == "--records") {
    options.records = value;
  } else if (name == "--jobs") {
    options.jobs = number<int>(name, value);
  } else if (name == "--rendered-every") {
    options.rendered_every = number<int>(name, value);
  } else if (name == "--explain") {
    options.explain = value;
  } else if (name == "--templates") {
    options.templates = value;
  } else if (name == "--scene") {
    options.scene = number<int>(name, value);
  } else if (name == "--camera") {
    const std::size_t x = value.find('x');
    options.width = number<int>(name, value.substr(0, x));
    options.height = number<int>(name, x == std::string::npos ? "" : value.substr(x + 1));
  } else if (name == "--families") {
    options.families = list(value);
  } else if (name == "--kinds") {
    options.kinds = list(value);
  } else if (name == "--parts") {
    options.parts = number<int>(name, value);
  } else if (name == "--noise-mm") {
    options.noise_mm = number<double>(name, value);
  } else if (name == "--expect-recall") {
    options.expect_recall = number<double>(name, value);
  } else if (name == "--workers") {
    options.workers = number<int>(name, value);
  } else if (name == "--repeats") {
    options.repeats = number<int>(name, value);
  } else {
    throw std::runtime_error(name + ": no such option; see --help");
  }
}

}  // namespace

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--help" || name == "-h") {
      std::fputs(kHelp, stdout);
      std::exit(0);
    }
    if (name == "--json") {
      options.json_only = true;
      continue;
    }
    if (name == "--peers") {
      options.peers = true;
      continue;
    }
    if (i + 1 == argc) throw std::runtime_error(name + ": expected a value after it; see --help");
    take(options, name, argv[++i]);
  }
  if (options.scene) options.first_scene = *options.scene, options.scenes = options.jobs = 1;
  if (!options.explain.empty() && !options.scene) throw std::runtime_error("--explain: expected --scene K beside it");
  if (options.jobs < 1 || options.scenes < 1 || options.stride < 1 || options.repeats < 1)
    throw std::runtime_error("--jobs, --scenes, --stride, --repeats: expected at least 1");
  return options;
}

std::vector<int> scene_numbers(const Options& options) {
  std::vector<int> numbers;
  for (int i = 0; i < options.scenes; ++i) numbers.push_back(options.first_scene + i * options.stride);
  return numbers;
}

}  // namespace beltpick::bench
