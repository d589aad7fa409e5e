#include "peerd/peer/record/rerun.hpp"

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"

namespace peerd::record {
namespace {

constexpr int kRerunFormat = 1;

}  // namespace

Rerun make_rerun(const config::Scenario& scenario, const std::filesystem::path& file, const SharedWorld& shared) {
  Rerun rerun{.name = scenario.name,
              .file = std::filesystem::absolute(file),
              .world = std::filesystem::absolute(scenario.world),
              .world_hash = shared.world.hash,
              .reading = scenario.reading,
              .configurations = {}};
  for (const config::RunSettings& run : scenario.runs) rerun.configurations.push_back(run.toml);
  return rerun;
}

std::string to_text(const Rerun& rerun) {
  const nlohmann::ordered_json json{{"format", kRerunFormat},
                                    {"name", rerun.name},
                                    {"file", rerun.file.string()},
                                    {"world", rerun.world.string()},
                                    {"world_hash", rerun.world_hash},
                                    {"inlines_when_needed", rerun.reading.inlines_when_needed},
                                    {"expansion", rerun.reading.expansion},
                                    {"lenient", rerun.reading.lenient},
                                    {"collide", rerun.reading.collide},
                                    {"unit", rerun.reading.unit},
                                    {"up", rerun.reading.up},
                                    {"world_name", rerun.reading.name},
                                    {"configurations", rerun.configurations}};
  // Paths may not be UTF-8. A path with a replaced character will be reported as missing.
  return json_text(json, 1) + '\n';
}

std::expected<Rerun, std::string> rerun_from(std::string_view text) {
  Rerun rerun;
  try {
    const auto json = parse_json(text);
    if (const int format = json.at("format").get<int>(); format != kRerunFormat) {
      return std::unexpected("it is of format " + std::to_string(format) + ", and this program reads " +
                             std::to_string(kRerunFormat));
    }
    rerun.name = json.at("name").get<std::string>();
    rerun.file = json.at("file").get<std::string>();
    rerun.world = json.at("world").get<std::string>();
    rerun.world_hash = json.at("world_hash").get<std::uint64_t>();
    rerun.reading.inlines_when_needed = json.at("inlines_when_needed").get<bool>();
    rerun.reading.expansion = json.at("expansion").get<std::uint32_t>();
    rerun.reading.lenient = json.value("lenient", false);  // older outputs have none
    rerun.reading.collide = json.value("collide", "");     // older outputs have none
    rerun.reading.unit = json.value("unit", "");           // older outputs have none
    rerun.reading.up = json.value("up", "");               // older outputs have none
    rerun.reading.name = json.at("world_name").get<std::string>();
    rerun.configurations = json.at("configurations").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception& e) {
    return std::unexpected(std::string("what its runs were made of can't be read: ") + e.what());
  }
  if (rerun.configurations.empty()) return std::unexpected("it names no run");
  return rerun;
}

}  // namespace peerd::record
