#pragma once
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>

#include "peerd/cli/commands/view_command.hpp"
#include "peerd/cli/lab/chaos_command.hpp"
#include "peerd/cli/lab/compare_command.hpp"
#include "peerd/cli/lab/mcap_command.hpp"
#include "peerd/cli/lab/replay_command.hpp"
#include "peerd/cli/lab/scenario_options.hpp"
#include "peerd/cli/lab/volumes_command.hpp"

namespace peerd {

// Functions that run the commands of the laboratory (peerd/lab) after their command lines are parsed. Each returns the
// exit code. `peerd-lab` runs them itself. `peerd`, which does not contain the laboratory, starts `peerd-lab` with the
// same arguments instead.
struct LabRuns {
  std::function<int(const ScenarioOptions&)> sim;
  std::function<int(const ChaosOptions&)> chaos;
  // `peerd` is the program that the scenario's peers run.
  std::function<int(const ScenarioOptions&, const std::filesystem::path& peerd)> scenario;
  std::function<int(const CompareOptions&)> compare;
  std::function<int(const ReplayOptions&)> replay;
  std::function<int(const std::string& world, const VolumesOptions&, std::ostream& out, std::ostream& err)> volumes;
  std::function<int(const McapOptions&, std::ostream& out, std::ostream& err)> mcap_export;
  std::function<int(const ViewOptions&)> view_recorded;
};

// Those that start `peerd-lab` with the words of this program's command line, in place of this program. Where it is not
// installed they say so, with exit code 3.
[[nodiscard]] LabRuns runs_of_other_program(std::span<char*> words);

// The program NAME in the folder that this one is in.
[[nodiscard]] std::filesystem::path program_beside(const char* name);

}  // namespace peerd
