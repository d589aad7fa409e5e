#include <array>
#include <memory>
#include <string>
#include <utility>

#include "peerd/cli/commands/join_command.hpp"
#include "peerd/cli/commands/run_command.hpp"
#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/program/shared_options.hpp"
#include "peerd/cli/shell/number_checks.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd {
namespace {

const InputError kFreshWithoutStore{"error: --fresh begins a store anew, and this peer has none; say --store DIR",
                                    kWrongUse};

void add_run_options(CLI::App& command, PeerOptions& peer, RunFlags& flags) {
  command
      .add_option("-c,--config", peer.config,
                  "a scenario file, or the name of an installed one; --peer says which of its peers this is")
      ->transform(installed().scenario());
  command.add_option("--overlay", peer.overlays, "a TOML file whose settings replace the configuration's (repeatable)")
      ->allow_extra_args(false)
      ->transform(installed().settings());
  command.add_option("--set", peer.sets, "KEY=VALUE over the configuration (repeatable)")->allow_extra_args(false);
  command
      .add_option("--world", flags.world,
                  "the world (VRML97, X3D, glTF, OBJ, STL, PLY, OFF), or the name of an installed one")
      ->transform(installed().world());
  command.add_flag("--lenient", flags.lenient, kLenientHelp);
  add_format_options(command, flags.collide, flags.unit, flags.up);
  command.add_option("--peer", peer.peer, "which of the configuration's peers (default: its only one)");
  command.add_option("--world-name", flags.world_name,
                     "what peerd ls calls it; worlds of one file and two names are two (default: that of its file)");
  add_own_options(command, peer, flags, ", without a configuration");
  command.add_option("--enslave", flags.enslaves, "the former name of --own")
      ->allow_extra_args(false)
      ->group("");  // not in the help
  add_network_options(command, flags);
  command.add_flag("--once", peer.once, "leave when the scenario is over; it begins when all its peers are here");
}

// Both tables of options of a command that runs a peer.
struct PeerFlags {
  PeerOptions peer;
  RunFlags run;
};

// Runs a peer as the options of `peerd run` or `peerd record` say, once they fit each other.
int run_with(PeerFlags& options) {
  auto& [peer, flags] = options;
  if (peer.config.empty() && flags.world.empty()) {
    return failed({"error: give a configuration (--config FILE) or a world (--world FILE)", kWrongUse});
  }
  if (!flags.enslaves.empty() && !flags.owns.empty()) {
    return failed({"error: --enslave and --own are two names of one option; leave out --enslave", kWrongUse});
  }
  if (!flags.enslaves.empty()) {
    print_warnings(std::array{std::string("warning: --enslave is now called --own")});
    flags.owns = std::move(flags.enslaves);
  }
  const bool describes_peer = !flags.name.empty() || flags.id || !flags.owns.empty();
  if (!peer.config.empty() && describes_peer) {
    return failed(
        {"error: --name, --id and --own describe a peer without a configuration; change one of the "
         "configuration's by --set, such as --set peer.a.id=5",
         kWrongUse});
  }
  if (peer.config.empty() && !peer.peer.empty()) {
    return failed({"error: --peer picks one of a configuration's peers; without one, say --name", kWrongUse});
  }
  if (peer.store.fresh && !peer.store.is_wanted()) return failed(kFreshWithoutStore);
  peer.sets = as_settings(flags, peer);
  return run_peer(peer);
}

}  // namespace

Command add_run(CLI::App& app) {
  const auto flags = std::make_shared<PeerFlags>();
  CLI::App* const command = app.add_subcommand("run", "a peer, in the foreground; SIGTERM leaves cleanly");
  command->footer(exit_codes("the world has errors"));
  add_run_options(*command, flags->peer, flags->run);
  add_store_options(*command, flags->peer.store, "none with a configuration, else one in this user's own folder");
  return {command, [flags] {
            flags->peer.store.by_default = flags->peer.config.empty();
            return run_with(*flags);
          }};
}

Command add_join(CLI::App& app) {
  struct Flags {
    JoinOptions join;
    RunFlags run;
    AskFlags ask;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* const command = app.add_subcommand(
      "join", "a peer, as run, in a world that others are in: it gets the world from them and needs no file");
  command->footer(exit_codes("what it got is damaged"));
  command->add_option("world", flags->join.request.world, "the world's name, as peerd ls says (default: the only one)");
  command->add_option("--from", flags->join.request.from,
                      "HOST:PORT of a peer that gives the world, as its log says, in place of asking who is here");
  add_ask_options(*command, flags->ask);
  add_own_options(*command, flags->join.peer, flags->run, "");
  command
      ->add_option(
          "--invite", flags->join.invitation,
          "what peerd invite has printed elsewhere: the world and its key, which is kept; -: from standard input")
      ->excludes("--open")
      ->excludes("--key")
      ->excludes("--password-file");
  command
      ->add_option("--port", flags->run.port,
                   "UDP port of its own, where the session uses unicast (default: the session's)")
      ->transform(whole_number_in(1, 65535));
  add_store_options(*command, flags->join.peer.store, "one in this user's own folder");
  return {command, [flags] {
            flags->join.peer.store.by_default = true;
            if (flags->join.peer.store.fresh && !flags->join.peer.store.is_wanted()) return failed(kFreshWithoutStore);
            flags->join.request.transport = flags->ask.transport();
            flags->join.request.key = {flags->run.key, flags->run.password};
            flags->join.request.open = flags->run.open;
            flags->run.interface = flags->ask.interface;
            flags->join.peer.sets = as_settings(flags->run, flags->join.peer);
            return run_join(flags->join);
          }};
}

Command add_record(CLI::App& app) {
  const auto flags = std::make_shared<PeerFlags>();
  CLI::App* const command =
      app.add_subcommand("record", "a peer, as run, that keeps all that it hears in its session, is told and sends");
  command->footer(exit_codes("the world has errors"));
  add_run_options(*command, flags->peer, flags->run);
  command->add_option("--out", flags->peer.capture, "the file, pcapng: Wireshark opens it, too")->required();
  command->add_flag("--opened", flags->peer.opened,
                    "what sealed datagrams say, and all other inputs, for peerd replay: as secret as the key (default: "
                    "sealed datagrams as they are on the network)");
  return {command, [flags] { return run_with(*flags); }};
}

Command add_replay(CLI::App& app, const LabRuns& lab) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* const command = app.add_subcommand("replay", "runs a recorded peer once more; does it send the same?");
  command->footer(exit_codes("the peer does something else, or the record can't be used"));
  command->add_option("file", options->file, "what peerd record or peerd sim --capture wrote")->required();
  command->add_option("--world", options->world, "where the world is now (default: where it was)");
  command->add_option("--record", options->record, "write what the peer did and believed, as peerd run does");
  command->add_option("--size-max", options->size_max_mib, "how large the file may be [MiB] (default: 1024)")
      ->transform(whole_number_in(1, kSizeMax_mib));
  command->add_flag("--json", options->json, "one JSON object");
  command->add_flag("-v,--verbose", options->verbose, "print the peer's log");
  return {command, [options, &lab] { return lab.replay(*options); }};
}

}  // namespace peerd
