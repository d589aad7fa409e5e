#include "figures.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

namespace peerd::bench {
namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(std::min(line.find(':') + 2, line.size()));
  }
  return "unknown";
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--quick") {
      options.quick = true;
    } else if (argument == "--out" && i + 1 < argc) {
      options.out = argv[++i];
    } else if (argument == "--commit" && i + 1 < argc) {
      options.commit = argv[++i];
    } else {
      options.arguments.emplace_back(argument);
    }
  }
  return options;
}

int run_main(int argc, char** argv, int (*run)(const Options&)) {
  try {
    return run(parse_options(argc, argv));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}

bool write_figures(const Options& options, const std::vector<Figure>& figures) {
  if (options.out.empty()) return true;
  nlohmann::ordered_json json;
  json["machine"] = {{"cpu", cpu_model()},         {"cores", std::thread::hardware_concurrency()},
                     {"compiler", BENCH_COMPILER}, {"flags", BENCH_FLAGS},
                     {"commit", options.commit},   {"quick", options.quick}};
  json["figures"] = nlohmann::ordered_json::object();
  std::string csv = "name,value,unit,against,ratio,low,high\n";
  for (const Figure& f : figures) {
    auto& entry = json["figures"][f.name] = {{"value", f.value}, {"unit", f.unit}, {"against", f.against}};
    entry["ratio"] = f.ratio ? nlohmann::ordered_json(*f.ratio) : nlohmann::ordered_json();
    char numbers[160];
    std::snprintf(numbers, sizeof numbers, "%.6g", f.value);
    csv += f.name + ',' + numbers + ',' + f.unit + ',' + f.against + ',';
    if (f.ratio) std::snprintf(numbers, sizeof numbers, "%.6g", *f.ratio);
    if (f.ratio) csv += numbers;
    std::snprintf(numbers, sizeof numbers, ",%.6g,%.6g\n", f.low, f.high);
    csv += numbers;
  }
  return write_beside(options, BENCH_GROUP ".json", json.dump(2) + '\n') &&
         write_beside(options, BENCH_GROUP ".csv", csv);
}

bool write_beside(const Options& options, const std::string& name, const std::string& text) {
  if (options.out.empty()) return true;
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  const auto path = std::filesystem::path(options.out) / name;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) std::fprintf(stderr, "error: %s cannot be written\n", path.c_str());
  return static_cast<bool>(file);
}

void Report::add_and_print(Figure f) {
  std::printf("%-44s %12.5g %-12s [%.5g %.5g] %s\n", f.name.c_str(), f.value, f.unit.c_str(), f.low, f.high,
              f.against.c_str());
  std::fflush(stdout);
  add(std::move(f));
}

void Report::wrong(const std::string& what) {
  std::printf("WRONG: %s\n", what.c_str());
  right_ = false;
}

bool read_numbers(const std::vector<std::string>& arguments, std::initializer_list<NumberOption> options) {
  if (arguments.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    const auto option = std::ranges::find(options, arguments[i], &NumberOption::first);
    if (option == options.end()) return false;
    const std::string& text = arguments[i + 1];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *option->second);
    if (error != std::errc{} || end != text.data() + text.size()) return false;
  }
  return true;
}

Quartiles quartiles(std::vector<double> samples) {
  assert(!samples.empty());
  std::ranges::sort(samples);
  const auto at = [&](std::size_t quarter) { return samples[quarter * (samples.size() - 1) / 4]; };
  return {at(1), at(2), at(3)};
}

}  // namespace peerd::bench
