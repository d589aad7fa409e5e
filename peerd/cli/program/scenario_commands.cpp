#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/program/shared_options.hpp"
#include "peerd/cli/shell/number_checks.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/wrong_use.hpp"
#include "peerd/lab/cluster/cluster_options.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd {
namespace {

constexpr NumberRange kChaosSeconds{kChaosSecondsMin, 3600.0};
constexpr std::int64_t kJobsMax = 1024, kTasksMax = 1'000'000;
constexpr std::int64_t kChaosSeedsMax = 1'000'000, kChaosPeersMax = 9;

void add_scenario_source(CLI::App& command, ScenarioOptions& options) {
  command.add_option("scenario", options.scenario, "the scenario, a TOML file, or the name of an installed one")
      ->required()
      ->transform(installed().scenario());
  command.add_option("--config", options.configs, "a TOML file whose settings replace the scenario's (repeatable)")
      ->allow_extra_args(false)
      ->transform(installed().settings());
  command.add_option("--set", options.sets, "KEY=VALUE, such as network.latency_ms=100; a list sweeps (repeatable)")
      ->allow_extra_args(false);
  command.add_flag_callback(
      "--lenient", [&options] { options.sets.emplace_back("lenient=true"); }, kLenientHelp);
}

void add_scenario_options(CLI::App& command, ScenarioOptions& options) {
  add_scenario_source(command, options);
  command.add_option("--seed", options.seed, "the first run's seed (default: the scenario's, else 1)")
      ->transform(whole_number_in(0, config::kSeedMax));
  command
      .add_option("--repeat", options.repeat,
                  "run everything with so many seeds, from that one on (default: the scenario's, else 1)")
      ->transform(whole_number_in(1, config::kRepeatMax));
  command.add_option("--out", options.out, "where the outputs go (default: out/NAME)");
  command.add_option("--samples", options.samples,
                     "rows of errors.csv, and of traffic.csv: all, none or N at most (default: 40000)");
  command.add_flag("--json", options.json, "print summary.json instead of the table");
}

void add_chaos_options(CLI::App& command, ChaosOptions& options) {
  auto* const chaos = command.add_option("--chaos", options.seeds,
                                         "no scenario: a generated world, peers that edit it, and faults of all kinds, "
                                         "by a seed or by each of FIRST..LAST");
  command.add_option("--count", options.count, "with --chaos: so many seeds from that one on (default: 1)")
      ->transform(whole_number_in(1, kChaosSeedsMax))
      ->needs(chaos);
  command.add_option("--chaos-seconds", options.seconds, "how long each run is [s], 22 at least (default: 60)")
      ->transform(number_in(kChaosSeconds))
      ->needs(chaos);
  command.add_option("--chaos-peers", options.peers, "the first peers only")
      ->transform(whole_number_in(1, kChaosPeersMax))
      ->needs(chaos);
  command.add_option("--chaos-without", options.without, "faults and edits to leave out, such as f3,e7,e10-20")
      ->needs(chaos);
  command.add_flag("!--no-shrink", options.shrinks, "do not look for a smaller run that fails, too")->needs(chaos);
}

void add_cluster_options(CLI::App& command, cluster::ClusterOptions& options) {
  const std::map<std::string, cluster::Runner> runners{{"processes", cluster::Runner::kProcesses},
                                                       {"slurm", cluster::Runner::kSlurm}};
  auto* const on = command
                       .add_option("--on", options.runner,
                                   "who does the runs: processes of this computer, which may die, or slurm, a cluster; "
                                   "the same command again runs what is missing")
                       ->transform(CLI::CheckedTransformer(runners).description(""))
                       ->option_text("processes|slurm")
                       ->excludes("--verbose");
  command.add_option("--tasks", options.tasks, "with --on: so many tasks at most, each of some runs (default: 100)")
      ->transform(whole_number_in(1, kTasksMax))
      ->needs(on);
  command
      .add_option("--slurm-options", options.slurm_options,
                  "with --on slurm: options of sbatch, such as \"--partition=short --time=10\"")
      ->needs(on);
  command.add_option("--task", options.items)->group("")->excludes(on);
}

// A run is of a scenario, or of chaos.
int run_sim_or_chaos(const CLI::App& command, ScenarioOptions& options, ChaosOptions& chaos, const LabRuns& lab) {
  options.cluster.program = std::filesystem::read_symlink("/proc/self/exe");
  options.cluster.version = program_version();
  const bool slurm = options.cluster.runner == cluster::Runner::kSlurm;
  if (slurm && command.get_option("--jobs")->count() > 0) {
    return failed({"error: --jobs is of this computer; Slurm decides how many tasks run at once", kWrongUse});
  }
  if (!slurm && !options.cluster.slurm_options.empty()) {
    return failed({"error: --slurm-options needs --on slurm", kWrongUse});
  }
  if (options.cluster.runner == cluster::Runner::kProcesses && command.get_option("--jobs")->count() == 0) {
    options.jobs = 0;
  }
  if (chaos.seeds.empty()) {
    if (options.scenario.empty()) {
      return failed({"error: scenario is required; see " + full_name(command) + " --help", kWrongUse});
    }
    return lab.sim(options);
  }
  std::vector<const char*> of_scenarios{"scenario", "--config", "--set",     "--lenient",
                                        "--seed",   "--repeat", "--samples", "--capture"};
  const bool elsewhere = options.cluster.runner != cluster::Runner::kHere || !options.cluster.items.empty();
  if (!elsewhere) of_scenarios.insert(of_scenarios.end(), {"--out", "--jobs"});
  for (const char* other : of_scenarios) {
    if (command.get_option(other)->count() > 0) {
      return failed({std::string("error: ") + other + " is of a scenario; --chaos has none", kWrongUse});
    }
  }
  chaos.json = options.json;
  chaos.cluster = options.cluster;
  chaos.jobs = options.jobs;
  chaos.out = options.out;
  return lab.chaos(chaos);
}

}  // namespace

Command add_sim(CLI::App& app, const LabRuns& lab) {
  const auto options = std::make_shared<ScenarioOptions>();
  const auto chaos = std::make_shared<ChaosOptions>();
  CLI::App* const command = app.add_subcommand("sim", "a scenario on a simulated network, as fast as it goes");
  command->footer(exit_codes("an expectation failed, or the world has errors"));
  add_scenario_options(*command, *options);
  command->add_option("--capture", options->captures,
                      "a folder for all that each peer hears and sends: PEER.pcapng, of a sweep in run-NNN");
  command->add_flag("-v,--verbose", options->verbose, "print the peers' logs");
  command
      ->add_option("--jobs", options->jobs,
                   "so many runs at once, each with a world of its own in memory; 0: as many as there are processors")
      ->transform(whole_number_in(0, kJobsMax))
      ->excludes("--verbose");
  command->get_option("scenario")->required(false);
  add_chaos_options(*command, *chaos);
  add_cluster_options(*command, options->cluster);
  return {command, [command, options, chaos, &lab] { return run_sim_or_chaos(*command, *options, *chaos, lab); }};
}

Command add_compare(CLI::App& app, const LabRuns& lab) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* const command =
      app.add_subcommand("compare", "a simulated scenario as it is and with other systems in its peers' place");
  command->footer(exit_codes("the world has errors"));
  ScenarioOptions& scenario = options->scenario;
  add_scenario_source(*command, scenario);
  command->get_option("--config")
      ->description("a TOML file whose settings replace the scenario's, for all of them (repeatable)");
  command->get_option("--set")->description("KEY=VALUE for all of them, such as network.latency_ms=100 (repeatable)");
  command
      ->add_option("--with", options->with,
                   "a system: the name of one that is installed, or a TOML file (default: all that are installed)")
      ->transform(installed().settings());
  command->add_option("--seed", scenario.seed, "the seed (default: the scenario's, else 1)")
      ->transform(whole_number_in(0, config::kSeedMax));
  command->add_option("--out", scenario.out, "where compare.html and compare.json go (default: out/compare-NAME)");
  command->add_flag("--json", scenario.json, "print compare.json instead of the table");
  return {command, [options, &lab] {
            options->baselines = installed().all("baselines", ".toml");
            return lab.compare(*options);
          }};
}

Command add_scenario(CLI::App& app, const LabRuns& lab) {
  const auto options = std::make_shared<ScenarioOptions>();
  CLI::App* const command = app.add_subcommand("scenario", "a scenario between real processes over real multicast");
  command->footer(exit_codes("an expectation failed, or the world has errors"));
  add_scenario_options(*command, *options);
  command->add_option("--interface", options->interface, "network interface (default: the scenario's, else lo)");
  auto* const netem =
      command->add_flag("--netem", options->netem,
                        "over the scenario's [network], by the kernel's netem, in namespaces of its own (as root)");
  command->add_flag("--capture", options->tcpdump, "what each peer sent and got, by tcpdump, as run-NNN.PEER.pcap")
      ->needs(netem);
  return {command, [options, &lab] { return lab.scenario(*options, program_beside("peerd")); }};
}

}  // namespace peerd
