#include "peerd/compare/compare_command.hpp"

#include <ctime>
#include <iostream>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/baselines/baseline_run.hpp"
#include "peerd/command_line/stop_signals.hpp"
#include "peerd/commands/print.hpp"
#include "peerd/compare/comparison.hpp"
#include "peerd/config/scenario.hpp"
#include "peerd/input/text_file.hpp"

namespace peerd {
namespace {

// Enough for all samples of the repository's scenarios, so that delays can be found.
constexpr report::RowLimits kKept{.samples = 3'000'000, .updates = 0, .datagrams = 0};

// A system's run: the scenario with its configuration over it, one value for each key that the scenario sweeps.
Result<std::optional<compare::Compared>> run_one(const CompareOptions& options, const std::filesystem::path& config,
                                                 const StopSignals& signals) {
  config::ScenarioRequest request{.file = options.scenario.scenario,
                                  .configs = options.scenario.configs,
                                  .sets = options.scenario.sets,
                                  .seed = options.scenario.seed,
                                  .sweep = false};
  if (!config.empty()) request.configs.push_back(config);
  const auto scenario = config::read_scenario(request);
  if (!scenario) return std::unexpected(scenario.error());
  const auto shared = share_world(scenario->world, scenario->reading, scenario->runs);
  if (!shared) return std::unexpected(shared.error());
  config::RunSettings run = scenario->runs.front();
  const auto objects = config::resolve(run, (*shared)->world.scene);
  if (!objects) return std::unexpected(objects.error());
  const std::string name = config.empty() ? "peerd" : config.stem().string();
  const auto go_on = [&](std::optional<double>) { return signals.signal() == 0; };
  const std::clock_t before = std::clock();
  auto record = baselines::run_of_any_system(run, **shared, {}, {}, nullptr, {.limits = kKept, .parts = {}}, go_on);
  const double cpu_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  if (!record) return std::unexpected(record.error());
  if (signals.signal() != 0) return std::nullopt;
  auto wrong = sim::compare_outcomes(*record, run, **shared, go_on);
  if (!wrong) return std::unexpected(wrong.error());
  record->wrong = *wrong;
  if (signals.signal() != 0) return std::nullopt;
  return compare::compared(name, *record, cpu_s, compare::key_moves(run, *objects, (*shared)->world.scene));
}

Result<void> write(const std::filesystem::path& out, const nlohmann::ordered_json& json, const std::string& picture) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) {
    return std::unexpected(InputError{"error: can't make the folder " + out.string() + ": " + error.message(), 3});
  }
  if (const auto done = write_text_file(out / "compare.json", json.dump(2) + "\n"); !done) return done;
  return write_text_file(out / "compare.svg", picture);
}

}  // namespace

int run_compare(const CompareOptions& options) {
  StopSignals signals("stopped: nothing is written");
  std::vector<std::filesystem::path> configs{{}};
  const auto& others = options.with.empty() ? options.baselines : options.with;
  if (others.empty()) return failed({"error: no other system is installed beside peerd; name one: --with FILE", 2});
  configs.insert(configs.end(), others.begin(), others.end());
  std::vector<compare::Compared> systems;
  for (const std::filesystem::path& config : configs) {
    const auto one = run_one(options, config, signals);
    if (!one) return failed(one.error());
    if (!*one) return signals.exit_code();
    systems.push_back(**one);
  }
  const std::string name = options.scenario.scenario.stem().string();
  const nlohmann::ordered_json json = {{"scenario", name}, {"systems", compare::to_json(systems)}};
  const auto out =
      options.scenario.out.empty() ? std::filesystem::path("out") / ("compare-" + name) : options.scenario.out;
  const auto written = write(out, json, compare::picture(name + ": other systems in the peers' place", systems));
  if (!written) return failed(written.error());
  if (options.scenario.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    std::cout << compare::table(systems) << (out / "compare.svg").string() << '\n';
  }
  return 0;
}

}  // namespace peerd
