#include <iostream>
#include <memory>
#include <utility>

#include "peerd/cli/commands/doctor_command.hpp"
#include "peerd/cli/commands/invite_command.hpp"
#include "peerd/cli/commands/join_command.hpp"
#include "peerd/cli/commands/keygen_command.hpp"
#include "peerd/cli/commands/members_command.hpp"
#include "peerd/cli/commands/relay_command.hpp"
#include "peerd/cli/commands/store_command.hpp"
#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/program/shared_options.hpp"
#include "peerd/cli/shell/number_checks.hpp"

namespace peerd {
namespace {

constexpr NumberRange kAskedSeconds{0.1, 60.0};
constexpr NumberRange kWaitedSeconds{1.0, 3600.0};
constexpr std::int64_t kPortMax = 65535;

}  // namespace

Command add_invite(CLI::App& app) {
  const auto options = std::make_shared<InviteOptions>();
  CLI::App* const command =
      app.add_subcommand("invite", "prints the command that brings somebody else into a world; it has the world's key");
  command->footer("Exit codes: 0 good, 2 wrong use, 3 there is no key of that world");
  command->add_option("world", options->world, "the world's name, as peerd ls says")->required();
  command->add_option("--key", options->key, "the file of its key (default: this user's own of that world)");
  command->add_flag("--relay", options->relay,
                    "print the key of a relay in place of that: it passes on what it cannot read (peerd relay)");
  return {command, [options] { return run_invite(*options, std::cout); }};
}

Command add_keygen(CLI::App& app) {
  const auto options = std::make_shared<KeygenOptions>();
  CLI::App* const command = app.add_subcommand(
      "keygen", "prints who this user is, for the administrator of a world; makes that where there is none yet");
  command->footer("Exit codes: 0 good, 2 the file is refused, 3 it can't be read or made");
  command->add_option("--identity", options->identity, "the file of the identity (default: this user's own)");
  return {command, [options] { return run_keygen(*options, std::cout); }};
}

Command add_members(CLI::App& app) {
  const auto options = std::make_shared<MembersOptions>();
  CLI::App* const command =
      app.add_subcommand("members", "lists the members of a world, begins their roster, and changes it");
  command->footer("Exit codes: 0 good, 1 the roster is damaged, 2 wrong use or not allowed, 3 the environment");
  command->add_option("world", options->world, "the world's name, as peerd ls says")->required();
  command->add_option("--begin", options->begin,
                      "begin a roster, in place of a key that all share, with this user under that name as its "
                      "administrator");
  command->add_option("--add", options->add, "NAME=KEY: a new member, with what peerd keygen has printed there")
      ->allow_extra_args(false);
  command->add_option("--role", options->role,
                      "of those that are added: observer (looks), editor or administrator (default: editor)");
  command
      ->add_option("--remove", options->remove,
                   "a member that is none from now on: it reads nothing that is sent after the others know it")
      ->allow_extra_args(false);
  command->add_option("--roster", options->roster, "the roster's file (default: this user's own of the world)");
  command->add_option("--identity", options->identity, "the file of who this user is (default: this user's own)");
  command->add_flag("--json", options->json, "one JSON object");
  return {command, [options] { return run_members(*options, std::cout); }};
}

Command add_relay(CLI::App& app) {
  const auto options = std::make_shared<RelayCommandOptions>();
  CLI::App* const command = app.add_subcommand(
      "relay", "passes a session's datagrams on between networks, without reading them, where somebody wants them");
  command->footer("Exit codes: 0 good, 2 wrong use, 3 the environment");
  command->add_option("--port", options->port, "the UDP port where peers (transport.relays) and relays reach it")
      ->transform(whole_number_in(1, kPortMax))
      ->capture_default_str();
  command
      ->add_option("--parent", options->parents,
                   "HOST:PORT of a relay above this one (repeatable: the first that answers; without one it is the "
                   "root of its tree)")
      ->allow_extra_args(false);
  command
      ->add_option("--island", options->islands,
                   "an interface whose peers multicast to each other (repeatable); of several relays there one is "
                   "active")
      ->allow_extra_args(false);
  command->add_option("--mesh", options->mesh, "HOST:PORT of a peer of a session by unicast (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--mesh-port", options->mesh_port, "the relay's own port among those peers")
      ->transform(whole_number_in(1, kPortMax));
  command->add_option("--group", options->group, "as transport.group of the islands' peers")->capture_default_str();
  command->add_option("--group-port", options->group_port, "as transport.port of the islands' peers")
      ->transform(whole_number_in(1, kPortMax))
      ->capture_default_str();
  command->add_option("--group-pool", options->group_pool, "as transport.group_pool of the islands' peers")
      ->transform(whole_number_in(0, 65536));
  command->add_option("--ttl", options->ttl, "hops of multicast datagrams")
      ->transform(whole_number_in(0, 255))
      ->capture_default_str();
  command->add_option("--dscp", options->dscp, "priority of its datagrams, 0 to 63")->transform(whole_number_in(0, 63));
  command->add_option("--relay-key", options->relay_key, "the file with the line of peerd invite WORLD --relay");
  command->add_option("--world", options->world, "a world of which this user has the key, in place of that");
  command->add_option("--key", options->key, "the file of the session's key, in place of that");
  command->add_flag("--open", options->open, "the session is not sealed");
  command
      ->add_option("--budget", options->budget_kib_s,
                   "KiB a second at most to each peer and relay; updates are left out first (default: no limit)")
      ->transform(number_in(NumberRange{8, 1e9}));
  command->add_option("--report", options->report_s, "says so often [s] what it has passed on (default: at the end)")
      ->transform(number_in(NumberRange{0.1, 86400}));
  command->add_flag("--json", options->json, "reports are JSON objects, one a line");
  add_log_option(*command, options->log);
  return {command, [options] {
            if (options->json) options->log = LogFormat::kJson;
            return run_relay(*options);
          }};
}

Command add_ls(CLI::App& app) {
  struct Flags {
    LsOptions ls;
    AskFlags ask;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* const command = app.add_subcommand("ls", "which worlds and peers there are in this network");
  command->footer("Exit codes: 0 good, also where there are none, 2 wrong use, 3 the environment");
  add_ask_options(*command, flags->ask);
  command->add_option("--seconds", flags->ls.seconds, "how long it asks (default: 1)")
      ->transform(number_in(kAskedSeconds));
  command->add_flag("--json", flags->ls.json, "one JSON object");
  return {command, [flags] {
            flags->ls.transport = flags->ask.transport();
            return run_ls(flags->ls, std::cout);
          }};
}

Command add_doctor(CLI::App& app) {
  struct Flags {
    DoctorOptions doctor;
    RunFlags network;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* const command = app.add_subcommand("doctor", "whether a peer could reach others from here, and how");
  command->footer(
      "Exit codes: 0 a peer could reach others, 1 those on this computer only, or something will hurt, 2 wrong use or "
      "configuration, 3 none. With --with: 0 multicast works both ways, 1 only unicast does, or something will hurt, 3 "
      "neither");
  command->add_option("-c,--config", flags->doctor.config, "a scenario file, of which the table [transport] counts")
      ->transform(installed().scenario());
  command->add_option("--set", flags->doctor.sets, "KEY=VALUE over it, such as transport.ttl=4 (repeatable)")
      ->allow_extra_args(false);
  add_network_options(*command, flags->network);
  command->add_option("--with", flags->doctor.with,
                      "HOST or HOST:PORT of another computer, where it runs with this one at the same time: tries "
                      "multicast, unicast and TCP between the two, both ways");
  command->add_option("--wait", flags->doctor.wait_s, "how long it waits for the other one to start [s] (default: 60)")
      ->transform(number_in(kWaitedSeconds));
  command->add_flag("--json", flags->doctor.json, "one JSON object");
  return {command, [flags] {
            auto sets = network_settings(flags->network);
            sets.insert(sets.end(), flags->doctor.sets.begin(), flags->doctor.sets.end());
            flags->doctor.sets = std::move(sets);
            return run_doctor(flags->doctor);
          }};
}

Command add_store(CLI::App& app) {
  struct Flags {
    StoreCheckOptions check;
    StoreExportOptions written;
    StoreMergeOptions merge;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* const command = app.add_subcommand("store", "what a peer's store of edits holds (peerd run --store)");
  command->require_subcommand(1);
  command->footer(exit_codes("it is damaged"));
  CLI::App* const check = command->add_subcommand("check", "read all of it: is it whole, and what has it of whom?");
  check->footer(exit_codes("it is damaged"));
  check->add_option("folder", flags->check.folder, "the folder of peerd run --store")->required();
  check->add_flag("--json", flags->check.json, "one JSON object");
  CLI::App* const written = command->add_subcommand("export", "the world as all edits have made it, as VRML");
  written->footer(exit_codes("it is damaged, or the world has errors"));
  written->add_option("folder", flags->written.folder, "the folder of peerd run --store")->required();
  written->add_option("--world", flags->written.world,
                      "the world that it began with (default: what the store keeps of it)");
  written->add_flag("--lenient", flags->written.reading.lenient, "read --world as --lenient of the peer has read it")
      ->needs("--world");
  written->add_option("--out", flags->written.file, "the file to write (default: standard output)");
  CLI::App* const merge =
      command->add_subcommand("merge", "bring the edits of a store that was put aside into another");
  merge->footer(exit_codes("it is damaged, or the two contradict each other"));
  merge->add_option("from", flags->merge.from, "the folder that has them")->required();
  merge->add_option("into", flags->merge.into, "the folder of peerd run --store, which no peer has open")->required();
  return {command, [flags, check, merge] {
            if (*merge) return run_store_merge(flags->merge, std::cout);
            return *check ? run_store_check(flags->check, std::cout) : run_store_export(flags->written, std::cout);
          }};
}

}  // namespace peerd
