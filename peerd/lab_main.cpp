// The program `peerd-lab`: `peerd` with the laboratory in it.
#include "peerd/cli/lab/scenario_command.hpp"
#include "peerd/cli/lab/sim_command.hpp"
#include "peerd/cli/lab/view_recorded.hpp"
#include "peerd/cli/program/program.hpp"

int main(int argc, char** argv) {
  const peerd::LabRuns lab{
      .sim = peerd::run_sim,
      .chaos = [](const peerd::ChaosOptions& options) { return peerd::run_chaos_seeds(options); },
      .scenario = peerd::run_scenario,
      .compare = peerd::run_compare,
      .replay = peerd::run_replay,
      .volumes = peerd::run_volumes,
      .mcap_export = peerd::run_mcap_export,
      .view_recorded = peerd::view_recorded,
  };
  return peerd::run_program(argc, argv, lab);
}
