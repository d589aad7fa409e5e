#include "peerd/lab/cluster/scenario_work.hpp"

#include <set>
#include <utility>
#include <variant>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/text_file.hpp"

namespace peerd::cluster {
namespace {

constexpr SizeLimit kProgramFile{4096 * kMiB, "no program is so long", 3};

void add_track(const motion::MotionSettings& motion, std::set<std::filesystem::path>& tracks) {
  if (const auto* track = std::get_if<motion::Track>(&motion.kind)) tracks.insert(track->file);
}

// The files of recorded motions, which a run's settings only name.
std::set<std::filesystem::path> tracks_of(const config::Scenario& scenario) {
  std::set<std::filesystem::path> tracks;
  for (const config::RunSettings& run : scenario.runs) {
    for (const auto& [object, motion] : run.motion) add_track(motion, tracks);
    for (const config::PeerSettings& peer : run.peers) {
      for (const auto& [object, motion] : peer.motion) add_track(motion, tracks);
    }
  }
  return tracks;
}

}  // namespace

Result<Work> work_of_this_program(const ClusterOptions& options, std::string kind) {
  const auto program = read_text_file(options.program, kProgramFile);
  if (!program) return std::unexpected(program.error());
  return Work{std::move(kind), options.version, hash_hex(*program), {}, {}};
}

Result<Work> scenario_work(const ClusterOptions& options, const std::vector<std::filesystem::path>& files,
                           const std::vector<std::string>& others, const config::Scenario& scenario,
                           const SharedWorld& shared) {
  auto work = work_of_this_program(options, "sim");
  if (!work) return work;
  nlohmann::ordered_json settings{others, scenario.name, shared.world.hash};
  for (const auto& file : files) {
    const auto text = read_text_file(file, kSettingsFile);
    if (!text) return std::unexpected(text.error());
    settings.push_back(hash_hex(*text));
  }
  for (const auto& file : tracks_of(scenario)) {
    const auto text = read_text_file(file, kTrackFile);
    if (!text) return std::unexpected(text.error());
    settings.push_back(hash_hex(*text));
  }
  for (std::size_t run = 0; run < scenario.runs.size(); ++run) {
    const config::RunSettings& of_run = scenario.runs[run];
    settings.push_back({of_run.params, of_run.toml, of_run.seed});
    for (const config::ScenarioEvent& event : of_run.events) settings.push_back(event.edit.text);
    work->items.push_back(fmt::format("run-{:03}", run + 1));
  }
  work->settings = hash_of(settings);
  return work;
}

}  // namespace peerd::cluster
