#include "peerd/cli/lab/compare_command.hpp"

#include <ctime>
#include <iostream>
#include <memory>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/console/stop_signals.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/baselines/baseline_run.hpp"
#include "peerd/lab/baselines/comparison.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd {
namespace {

// Enough for all samples of the repository's scenarios, so that delays can be found.
constexpr measure::RowLimits kKept{.samples = 3'000'000, .updates = 0, .datagrams = 0};

// A scenario that is ready to run by one system: it with that system's configuration over it, and one value for each
// key that the scenario sweeps.
struct Ready {
  std::string name;
  config::RunSettings run;
  std::unique_ptr<const SharedWorld> shared;
};
Result<Ready> ready(const ScenarioOptions& options, const std::filesystem::path& config) {
  config::ScenarioRequest request{
      .file = options.scenario, .configs = options.configs, .sets = options.sets, .seed = options.seed, .sweep = false};
  if (!config.empty()) request.configs.push_back(config);
  auto scenario = config::read_scenario(request);
  if (!scenario) return std::unexpected(scenario.error());
  print_warnings(scenario->warnings);
  auto shared = share_world(scenario->world, scenario->reading, scenario->runs);
  if (!shared) return std::unexpected(shared.error());
  Ready out{config.stem().string(), scenario->runs.front(), *std::move(shared)};
  if (config.empty()) out.name = out.run.baseline.system == config::BaselineSystem::kNone ? "peerd" : "as it is";
  out.run.compare_outcomes = false;  // all are compared with one truth
  return out;
}

// `truth`: of the scenario as it is. None where a signal stops it.
Result<std::optional<baselines::Compared>> run_one(const Ready& system, const Ready& truth,
                                                   const StopSignals& signals) {
  const Scene& scene = system.shared->world.scene;
  const auto objects = config::resolve(system.run, scene);
  if (!objects) return std::unexpected(objects.error());
  const auto go_on = [&](std::optional<double>) { return signals.signal() == 0; };
  const std::clock_t before = std::clock();
  auto record =
      baselines::run_of_any_system(system.run, *system.shared, {}, {}, nullptr, {.limits = kKept, .parts = {}}, go_on);
  const double cpu_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  if (!record) return std::unexpected(record.error());
  if (signals.signal() != 0) return std::nullopt;
  auto wrong = sim::compare_outcomes(*record, truth.run, *truth.shared, go_on);
  if (!wrong) return std::unexpected(wrong.error());
  record->wrong = *wrong;
  if (signals.signal() != 0) return std::nullopt;
  return baselines::compared(system.name, *record, cpu_s, baselines::key_moves(system.run, *objects, scene));
}

Result<void> write_comparison(const std::filesystem::path& out, const nlohmann::ordered_json& json,
                              const std::string& page) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) {
    return std::unexpected(
        InputError{"error: can't make the folder " + out.string() + ": " + error.message(), kSystemFailed});
  }
  if (const auto done = write_text_file(out / "compare.json", json_text(json) + "\n"); !done) return done;
  return write_text_file(out / "compare.html", page);
}

}  // namespace

int run_compare(const CompareOptions& options) {
  StopSignals signals("stopped: nothing is written");
  std::vector<std::filesystem::path> configs{{}};
  const auto& others = options.with.empty() ? options.baselines : options.with;
  if (others.empty())
    return failed({"error: no other system is installed beside peerd; name one: --with FILE", kWrongUse});
  configs.insert(configs.end(), others.begin(), others.end());
  std::vector<baselines::Compared> systems;
  const auto as_it_is = ready(options.scenario, {});
  if (!as_it_is) return failed(as_it_is.error());
  print_warnings((*as_it_is).shared->findings());
  signals.note_from_now_on("stopped at once by a second signal: nothing is written");
  for (const std::filesystem::path& config : configs) {
    const auto system = ready(options.scenario, config);
    if (!system) return failed(system.error());
    const auto one = run_one(*system, *as_it_is, signals);
    if (!one) return failed(one.error());
    if (!*one) return signals.exit_code();
    systems.push_back(**one);
  }
  const std::string name = options.scenario.scenario.stem().string();
  const nlohmann::ordered_json json = {{"scenario", name}, {"systems", baselines::to_json(systems)}};
  const auto out =
      options.scenario.out.empty() ? std::filesystem::path("out") / ("compare-" + name) : options.scenario.out;
  const auto written =
      write_comparison(out, json, baselines::page(name + ": other systems in the peers' place", systems));
  if (!written) return failed(written.error());
  if (options.scenario.json) {
    std::cout << json_text(json) << '\n';
  } else {
    std::cout << baselines::table(systems) << (out / "compare.html").string() << '\n';
  }
  return 0;
}

}  // namespace peerd
