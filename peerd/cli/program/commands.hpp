#pragma once
#include "peerd/cli/program/command.hpp"
#include "peerd/cli/program/lab_runs.hpp"

namespace peerd {

// Each adds a command, with its options, to the program's command line. `lab` runs what is of the laboratory; it has to
// outlive the command.

// A peer, and what one has recorded (peer_commands.cpp).
[[nodiscard]] Command add_run(CLI::App& app);
[[nodiscard]] Command add_join(CLI::App& app);
[[nodiscard]] Command add_record(CLI::App& app);
[[nodiscard]] Command add_replay(CLI::App& app, const LabRuns& lab);
// A session: who is in it, who may be, what is left of it, whether this computer reaches it (session_commands.cpp).
[[nodiscard]] Command add_invite(CLI::App& app);
[[nodiscard]] Command add_keygen(CLI::App& app);
[[nodiscard]] Command add_members(CLI::App& app);
[[nodiscard]] Command add_relay(CLI::App& app);
[[nodiscard]] Command add_ls(CLI::App& app);
[[nodiscard]] Command add_doctor(CLI::App& app);
[[nodiscard]] Command add_store(CLI::App& app);
// A scenario (scenario_commands.cpp).
[[nodiscard]] Command add_sim(CLI::App& app, const LabRuns& lab);
[[nodiscard]] Command add_scenario(CLI::App& app, const LabRuns& lab);
[[nodiscard]] Command add_compare(CLI::App& app, const LabRuns& lab);
// A world (world_commands.cpp).
[[nodiscard]] Command add_new(CLI::App& app);
[[nodiscard]] Command add_check(CLI::App& app);
[[nodiscard]] Command add_collide(CLI::App& app);
[[nodiscard]] Command add_volumes(CLI::App& app, const LabRuns& lab);
[[nodiscard]] Command add_bake(CLI::App& app);
[[nodiscard]] Command add_export(CLI::App& app, const LabRuns& lab);
// A peer that is running (client_commands.cpp).
[[nodiscard]] Command add_ctl(CLI::App& app);
[[nodiscard]] Command add_top(CLI::App& app);
[[nodiscard]] Command add_view(CLI::App& app, const LabRuns& lab);
// The program itself (help_commands.cpp).
[[nodiscard]] Command add_help(CLI::App& app);
[[nodiscard]] Command add_version(CLI::App& app);
[[nodiscard]] const char* program_version();  // such as "peerd 0.2.0"

}  // namespace peerd
