#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include <string.h>  // explicit_bzero, which is no part of C++
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/motion/key_codes.hpp"
#include "peerd/client/ctl_command.hpp"
#include "peerd/client/top_command.hpp"
#include "peerd/command_line/installed_files.hpp"
#include "peerd/command_line/number_checks.hpp"
#include "peerd/command_line/standard_streams.hpp"
#include "peerd/command_line/stop_signals.hpp"
#include "peerd/command_line/wrong_use.hpp"
#include "peerd/commands/bake_command.hpp"
#include "peerd/commands/chaos_command.hpp"
#include "peerd/commands/check_command.hpp"
#include "peerd/commands/collide_command.hpp"
#include "peerd/commands/doctor_command.hpp"
#include "peerd/commands/join_command.hpp"
#include "peerd/commands/print.hpp"
#include "peerd/commands/replay_command.hpp"
#include "peerd/commands/run_command.hpp"
#include "peerd/commands/scenario_command.hpp"
#include "peerd/commands/scenario_options.hpp"
#include "peerd/commands/sim_command.hpp"
#include "peerd/commands/store_command.hpp"
#include "peerd/config/scenario.hpp"
#include "peerd/export/export_command.hpp"
#include "peerd/export/mcap_command.hpp"
#include "peerd/feed/pose_feed.hpp"
#include "peerd/input/json_line.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/keys/invitation.hpp"
#include "peerd/membership/invite_command.hpp"
#include "peerd/membership/keygen_command.hpp"
#include "peerd/membership/members_command.hpp"
#include "peerd/peer/run_flags.hpp"
#include "peerd/view/view_command.hpp"

namespace peerd {
namespace {

constexpr int kWrongUse = 2;
constexpr int kEnvironment = 3;
constexpr const char* kVersion = "peerd " PEERD_VERSION;

// The world times that a world is asked at [s]. Beyond them a tick is lost in rounding.
constexpr NumberRange kWorldTimes_s{-1e12, 1e12};
constexpr NumberRange kTicksPerSecond{1e-6, 1e6};
constexpr double kQuaternionMax = 2.0;  // of one component; the peer checks their norm
constexpr std::int64_t kSizeMax_mib = 1 << 20;
constexpr std::int64_t kKeyCodeMax = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kEventCountMax = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kViewHzMax = 240;
constexpr std::int64_t kChaosSeedsMax = 1'000'000, kChaosPeersMax = 9;
constexpr NumberRange kAskedSeconds{0.1, 60.0};
constexpr NumberRange kChaosSeconds{kChaosSecondsMin, 3600.0};
constexpr std::int64_t kPeerIdMax = std::numeric_limits<std::uint32_t>::max();

const InputError kFreshWithoutStore{"error: --fresh begins a store anew, and this peer has none; say --store DIR",
                                    kWrongUse};

// The scenarios and worlds that are installed with this program.
const InstalledFiles& installed() {
  static const InstalledFiles files = InstalledFiles::of_this_program(PEERD_SHARE);
  return files;
}

// The defaults are those of config::TransportSettings.
void add_network_options(CLI::App& command, RunFlags& flags) {
  command.add_option("--interface", flags.interface,
                     "network interface, such as eth0 (default: the configuration's, else the only one that can "
                     "multicast, else lo)");
  command.add_option("--group", flags.group,
                     "multicast group of region 0, IPv4 or IPv6 (default: the configuration's, else 239.192.80.0)");
  command.add_option("--port", flags.port, "UDP port (default: the configuration's, else 47474)")
      ->transform(whole_number_in(1, 65535));
}

void add_scenario_options(CLI::App& command, ScenarioOptions& options) {
  command.add_option("scenario", options.scenario, "the scenario, a TOML file, or the name of an installed one")
      ->required()
      ->transform(installed().scenario());
  command.add_option("--config", options.configs, "a TOML file whose settings replace the scenario's (repeatable)")
      ->allow_extra_args(false)
      ->transform(installed().settings());
  command.add_option("--set", options.sets, "KEY=VALUE, such as network.latency_ms=100; a list sweeps (repeatable)")
      ->allow_extra_args(false);
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

// The options of a peer that no configuration describes, and of all others.
void add_own_options(CLI::App& command, PeerOptions& peer, RunFlags& flags, const std::string& described) {
  command.add_option("--name", flags.name, "this peer's name" + described + " (default: peer)");
  command
      .add_option("--id", flags.id,
                  "this peer's number; each peer needs its own (default: that of its store, else a random one)")
      ->transform(whole_number_in(1, kPeerIdMax));
  command.add_option("--own", flags.owns, "a node of the world that this peer runs (repeatable)")
      ->allow_extra_args(false);
  command.add_option("--control", peer.control,
                     "where peerd ctl reaches this peer: the path of a socket, or \"\" for none (default: the "
                     "configuration's, else one in this user's own folder)");
  command
      .add_option(
          "--view", peer.view,
          "serve the viewer there (default: the configuration's, else none; without a value 127.0.0.1:0, a port "
          "that the system chooses)")
      ->expected(0, 1)
      ->option_text("[ADDRESS:PORT]")
      ->default_str("127.0.0.1:0");
  command.add_option("--record", peer.record, "write what this peer did and believed to a file when it leaves");
  command.add_flag("--take-over", peer.take_over,
                   "begin at once, without asking for a second whether this peer is running already: that one ends");
  auto* const open = command.add_flag("--open", flags.open,
                                      "nothing is sealed: whoever is on the network can listen, and speak as any peer");
  auto* const key =
      command
          .add_option("--key", flags.key,
                      "the file of the key by which the world's peers seal all that they send (default: the "
                      "configuration's, else this user's own of that world, which is made where there is none)")
          ->excludes(open);
  command
      .add_option("--password-file", flags.password,
                  "the file of a password that makes the key, in place of --key; -: asks for it")
      ->excludes(open)
      ->excludes(key);
  auto* const json = command.add_flag_callback(
      "--json", [&peer] { peer.log = LogFormat::kJson; }, "the same as --log json");
  const auto set_format = [&peer](const std::string& word) {
    peer.log = word == "json" ? LogFormat::kJson : word == "journal" ? LogFormat::kJournal : LogFormat::kText;
  };
  command
      .add_option_function<std::string>(
          "--log", set_format,
          "what log lines are: text, json, or journal, which has priorities for systemd's (default: text)")
      ->check(CLI::IsMember(std::vector<std::string>{"text", "json", "journal"}).description(""))
      ->excludes(json);
  command.add_flag("-v,--verbose", peer.verbose, "log updates and predictions too");
}

void add_run_options(CLI::App& command, PeerOptions& peer, RunFlags& flags) {
  command
      .add_option("-c,--config", peer.config,
                  "a scenario file, or the name of an installed one; --peer says which of its peers this is")
      ->transform(installed().scenario());
  command.add_option("--overlay", peer.overlays, "a TOML file whose settings replace the configuration's (repeatable)")
      ->allow_extra_args(false)
      ->transform(installed().settings());
  command.add_option("--set", peer.sets, "KEY=VALUE over the configuration (repeatable)")->allow_extra_args(false);
  command.add_option("--world", flags.world, "the VRML97 world, or the name of an installed one")
      ->transform(installed().world());
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

void add_store_options(CLI::App& command, StoreOptions& store, const std::string& by_default) {
  command.add_option("--store", store.folder,
                     "a folder in which the edits of all peers are kept: the world is there again after all have "
                     "left; \"\" for none (default: " +
                         by_default + ")");
  command.add_flag("--fresh", store.fresh, "begin with the world's file: the store before is put aside");
}

// The key of `peerd ctl key`, with the modifiers that are held down.
struct KeyFlags {
  std::string name;
  bool shift = false, control = false, alt = false, meta = false, keypad = false;
  std::optional<std::int32_t> value;
  std::int32_t state = 0;
};

// The pose of `peerd ctl pose`.
struct PoseFlags {
  std::string object;
  std::vector<double> position_m, orientation_xyzw;
};

// The edit of `peerd ctl add`, `remove`, `move`, `set`, `own`, `grab`, `steal`, `release`, `data` and `send`.
struct EditFlags {
  std::string file, path, under, field;
  std::vector<std::string> value;
  std::optional<std::string> key, data;
  std::string topic, text;
  bool removes = false;
  std::vector<std::string> kinds;  // of `subscribe`
};

struct CtlCommands {
  CLI::App *status, *peers, *objects, *key, *pose, *add, *remove, *move, *set, *own, *grab, *steal, *release, *data;
  CLI::App *lock, *unlock;
  CLI::App *send, *undo, *redo, *conflicts, *subscribe, *save, *leave;

  // The one of those whose only argument is a path; null: it is another one.
  [[nodiscard]] const CLI::App* with_path_alone() const {
    for (const CLI::App* const command : {remove, own, grab, steal, release, lock, unlock}) {
      if (*command) return command;
    }
    return nullptr;
  }
};

void add_edit_commands(CLI::App& ctl, CtlCommands& commands, CtlOptions& options, EditFlags& edit) {
  commands.add = ctl.add_subcommand("add", "adds the nodes of a VRML text to the scene, for all peers");
  commands.add->add_option("file", edit.file, "the text; -: from standard input")->required();
  commands.add->add_option("--under", edit.under, "path of the node that they stand in (default: the top level)");
  commands.remove = ctl.add_subcommand("remove", "removes a node with all below it");
  commands.remove->add_option("path", edit.path, "its path, or its DEF name")->required();
  commands.move = ctl.add_subcommand("move", "moves a node with all below it in the tree; its fields stay");
  commands.move->add_option("path", edit.path, "its path")->required();
  commands.move->add_option("parent", edit.under, "path of the new parent (default: the top level)");
  commands.set = ctl.add_subcommand("set", "sets a field of a node");
  commands.set->add_option("path", edit.path, "its path, or its DEF name")->required();
  commands.set->add_option("field", edit.field, "such as translation, scale, collisionResponse")->required();
  commands.set->add_option("value", edit.value, "in the notation of VRML: 1 2 3, TRUE, \"Box { size 1 1 1 }\"")
      ->required()
      ->expected(-1);
  const auto add_owning = [&](const char* name, const char* what) {
    CLI::App* const command = ctl.add_subcommand(name, what);
    command->add_option("path", edit.path, "its path")->required();
    return command;
  };
  commands.own = add_owning("own", "makes an object this peer's: it takes what nobody owns, and asks an owner");
  commands.grab = add_owning("grab", "the same, and then this peer gives it to nobody who asks");
  commands.steal = add_owning("steal", "takes an object without asking its owner, where the world's settings allow it");
  commands.release = add_owning("release", "makes an object of this peer nobody's");
  commands.lock = add_owning("lock", "keeps all others from changing an object and what is below it");
  commands.unlock = add_owning("unlock", "lets them change it again");
  commands.data = ctl.add_subcommand("data", "a value that applications keep at a node: prints it, or sets it for all");
  commands.data->add_option("path", edit.path, "the node's path, or its DEF name")->required();
  commands.data->add_option("key", edit.key, "which one (default: prints the keys that it has)");
  auto* const value = commands.data->add_option("value", edit.data, "what it is from now on (default: prints it)");
  commands.data->add_flag("--remove", edit.removes, "removes the key")->excludes(value);
  commands.send = ctl.add_subcommand("send", "sends a message to all peers that are here");
  commands.send->add_option("topic", edit.topic, "what it is about")->required();
  commands.send->add_option("text", edit.text, "what it says")->required();
  commands.undo = ctl.add_subcommand("undo", "undoes the last edit of this peer that others have not overwritten");
  commands.redo = ctl.add_subcommand("redo", "redoes what this peer has undone last");
  commands.conflicts = ctl.add_subcommand("conflicts", "edits that are lost by others made at the same time");
  commands.subscribe =
      ctl.add_subcommand("subscribe", "prints a line of JSON for each event, as it comes, until the peer ends");
  commands.subscribe->add_option("kinds", edit.kinds, "objects, contacts, peers, data, messages, edits (default: all)");
  commands.subscribe->add_option("--count", options.events, "ends after that many events")
      ->transform(whole_number_in(1, kEventCountMax));
  commands.save = ctl.add_subcommand("save", "writes the scene as it is now as a world file");
  commands.save->add_option("file", options.save, "(default: standard output)");
}

CtlCommands add_ctl_commands(CLI::App& ctl, CtlOptions& options, KeyFlags& key, PoseFlags& pose, EditFlags& edit) {
  ctl.require_subcommand(1);
  ctl.footer(
      "Exit codes: 0 done, 1 a key or a pose without its full effect, 2 wrong use, or the peer refused, 3 no peer "
      "answers");
  auto* control =
      ctl.add_option("--control", options.socket, "the peer's control socket (default: that of the peer of --name)");
  ctl.add_option("--name", options.name, "the peer's name (default: the only one that this user runs)")
      ->excludes(control);
  ctl.add_flag("--json", options.json, "the peer's own reply, one JSON object");
  CtlCommands commands{};
  commands.status = ctl.add_subcommand("status", "who it is, its session, its own objects, its counters");
  commands.peers =
      ctl.add_subcommand("peers", "how the others are heard, and the clocks: delays, losses, bytes by peer and region");
  commands.objects = ctl.add_subcommand("objects", "all objects that some peer runs");
  commands.key = ctl.add_subcommand("key", "presses a key: the world's KeySensors get it");
  commands.key->add_option("key", key.name, "a browser's name of it, such as ArrowUp, a, Enter, F1");
  commands.key->add_flag("--shift", key.shift, "with Shift held down");
  commands.key->add_flag("--control-key", key.control, "with Control held down");
  commands.key->add_flag("--alt", key.alt, "with Alt held down");
  commands.key->add_flag("--meta", key.meta, "with Meta held down");
  commands.key->add_flag("--keypad", key.keypad, "on the numeric keypad");
  commands.key->add_option("--value", key.value, "instead of a name: the Qt::Key")
      ->transform(whole_number_in(0, kKeyCodeMax));
  commands.key->add_option("--state", key.state, "with --value: the Qt::ButtonState (default: 0)")
      ->transform(whole_number_in(0, kKeyCodeMax));
  commands.pose =
      ctl.add_subcommand("pose", "puts an object somewhere that a program outside moves: where it stands then");
  commands.pose->add_option("object", pose.object, "its path, as in the configuration")->required();
  commands.pose->add_option("position", pose.position_m, "x y z in the world [m]")
      ->required()
      ->expected(3)
      ->transform(number_in({-feed::kPositionMax_m, feed::kPositionMax_m}));
  commands.pose->add_option("--orientation", pose.orientation_xyzw, "a quaternion, x y z w (default: as before)")
      ->expected(4)
      ->transform(number_in({-kQuaternionMax, kQuaternionMax}));
  add_edit_commands(ctl, commands, options, edit);
  commands.leave = ctl.add_subcommand("leave", "leaves the session and ends");
  for (CLI::App* command : ctl.get_subcommands({})) command->fallthrough();
  return commands;
}

std::string pose_request(const PoseFlags& pose) {
  nlohmann::json request{{"do", "pose"}, {"object", pose.object}, {"position_m", pose.position_m}, {"jump", true}};
  if (!pose.orientation_xyzw.empty()) request["orientation_xyzw"] = pose.orientation_xyzw;
  return json_line(request);
}

Result<std::string> edit_request(const CtlCommands& commands, const EditFlags& edit) {
  nlohmann::json request;
  if (*commands.add) {
    constexpr SizeLimit kText{kMiB, "no operation is so long"};
    const auto text =
        edit.file == "-" ? read_text(std::cin, "standard input", kText) : read_text_file(edit.file, kText);
    if (!text) return std::unexpected(text.error());
    request = {{"do", "add"}, {"text", *text}};
  } else if (const CLI::App* const named = commands.with_path_alone()) {
    request = {{"do", named->get_name()}, {"path", edit.path}};
  } else if (*commands.data) {
    if (edit.removes && !edit.key) return std::unexpected(InputError{"error: --remove: which key?"});
    request = {{"do", "data"}, {"path", edit.path}};
    if (edit.key) request["key"] = *edit.key;
    if (edit.data) request["value"] = *edit.data;
    if (edit.removes) request["remove"] = true;
  } else if (*commands.send) {
    request = {{"do", "send"}, {"topic", edit.topic}, {"text", edit.text}};
  } else if (*commands.move) {
    request = {{"do", "move"}, {"path", edit.path}};
  } else {
    std::string value;
    for (const std::string& word : edit.value) value += (value.empty() ? "" : " ") + word;
    request = {{"do", "set"}, {"path", edit.path}, {"field", edit.field}, {"value", value}};
  }
  if (!edit.under.empty()) request["under"] = edit.under;
  return json_line(request);
}

Result<std::string> ctl_request(const CtlCommands& commands, const KeyFlags& key, const PoseFlags& pose,
                                const EditFlags& edit) {
  if (*commands.status) return R"({"do":"status"})";
  if (*commands.peers) return R"({"do":"peers"})";
  if (*commands.objects) return R"({"do":"objects"})";
  if (*commands.pose) return pose_request(pose);
  if (*commands.leave) return R"({"do":"leave"})";
  if (*commands.save) return R"({"do":"world"})";
  if (*commands.undo) return R"({"do":"undo"})";
  if (*commands.redo) return R"({"do":"redo"})";
  if (*commands.conflicts) return R"({"do":"conflicts"})";
  if (*commands.subscribe) {
    nlohmann::json request{{"do", "subscribe"}};
    if (!edit.kinds.empty()) request["to"] = edit.kinds;
    return json_line(request);
  }
  const bool edits = commands.with_path_alone() != nullptr || *commands.add || *commands.move || *commands.set ||
                     *commands.data || *commands.send;
  if (edits) return edit_request(commands, edit);
  if (key.name.empty() == !key.value) {
    return std::unexpected(InputError{"error: which key? Say its name, such as ArrowUp, or --value NUMBER"});
  }
  const bool held = key.shift || key.control || key.alt || key.meta || key.keypad;
  if (key.value ? held : key.state != 0) {
    return std::unexpected(InputError{"error: --shift and its like go with a key's name, --state goes with --value"});
  }
  if (key.value) return nlohmann::json{{"do", "key"}, {"value", *key.value}, {"state", key.state}}.dump();
  const auto named = find_key(
      key.name, {.shift = key.shift, .control = key.control, .alt = key.alt, .meta = key.meta, .keypad = key.keypad});
  if (!named) return std::unexpected(InputError{"error: " + named.error()});
  return nlohmann::json{{"do", "key"}, {"value", named->value}, {"state", named->state}}.dump();
}

// The last line of a command's help. `finding` is what 1 means there.
std::string exit_codes(const std::string& finding) {
  return "Exit codes: 0 good, 1 " + finding + ", 2 wrong use or configuration, 3 the environment";
}

// A command of the program: its entry in the command line, and what runs it once that is parsed. `run` keeps the
// options alive that `app` writes to.
struct Command {
  CLI::App* app;
  std::function<int()> run;
};

// The command line of a command about a world, without a peer.
template <class Options>
struct WorldFlags {
  std::string world;
  Options options;
};

template <class Options>
CLI::App* add_world_command(CLI::App& app, const char* name, const char* what, WorldFlags<Options>& flags) {
  CLI::App* const command = app.add_subcommand(name, what);
  command->footer(exit_codes("the world has errors"));
  command
      ->add_option("world", flags.world,
                   "the VRML97 world, or the name of an installed one; - reads it from standard input")
      ->required()
      ->transform(installed().world());
  command->add_flag("--json", flags.options.json, "one JSON object");
  command
      ->add_option("--expansion", flags.options.reading.expansion,
                   "how many times as much as usual its files may hold, unpack and sweep to (default: 1)")
      ->transform(whole_number_in(1, config::kExpansionMax));
  return command;
}

Command add_check(CLI::App& app) {
  const auto flags = std::make_shared<WorldFlags<CheckOptions>>();
  CLI::App* const command = add_world_command(
      app, "check", "read a world; problems as FILE:LINE:COLUMN; statistics; polygons' defects", *flags);
  command->add_option("--write", flags->options.copy, "write the world to a file, as one text that needs no other");
  command
      ->add_option("--at", flags->options.at_s, "say where its own movement has brought things after so many seconds")
      ->transform(number_in(kWorldTimes_s));
  return {command, [flags] { return run_check(flags->world, flags->options, std::cout, std::cerr); }};
}

Command add_collide(CLI::App& app) {
  const auto flags = std::make_shared<WorldFlags<CollideOptions>>();
  CollideOptions& options = flags->options;
  CLI::App* const command = add_world_command(
      app, "collide", "which objects of a world collide: all its interests, once or tick by tick", *flags);
  command->footer(exit_codes("the world has errors, or Shapes that can't be asked") +
                  ", 130 or 143 stopped by a signal\nColliding or not is no finding.");
  command->add_option("--at", options.at_s, "when: the time of its TimeSensors [s] (default: 0)")
      ->transform(number_in(kWorldTimes_s));
  auto* const until =
      command->add_option("--until", options.until_s, "from then on until this time [s]: what begins and what ends")
          ->transform(number_in(kWorldTimes_s));
  command->add_option("--hz", options.hz, "ticks a second (default: 60)")
      ->needs(until)
      ->transform(number_in(kTicksPerSecond));
  command->add_flag("--realigned-boxes", options.realigned_boxes,
                    "type box by the thesis's larger boxes, which no vertex is read for");
  return {command, [flags] {
            CollideOptions& asked = flags->options;
            if (!asked.until_s) return run_collide(flags->world, asked, std::cout, std::cerr);
            const std::string nothing = "stopped at once: no result is complete";
            StopSignals signals(nothing);
            signals.note_from_now_on(nothing);
            asked.interrupted = [&signals] { return signals.signal() != 0; };
            if (isatty(STDERR_FILENO) != 0) asked.progress = &std::cerr;
            const int code = run_collide(flags->world, asked, std::cout, std::cerr);
            return code == kInterrupted ? signals.exit_code() : code;
          }};
}

Command add_bake(CLI::App& app) {
  const auto flags = std::make_shared<WorldFlags<BakeOptions>>();
  CLI::App* const command =
      add_world_command(app, "bake", "write the hierarchy files that a world's Shapes name", *flags);
  return {command, [flags] { return run_bake(flags->world, flags->options, std::cout, std::cerr); }};
}

Command add_export(CLI::App& app) {
  const auto flags = std::make_shared<WorldFlags<ExportOptions>>();
  CLI::App* const command =
      add_world_command(app, "export", "write a world, a run or a capture for other programs", *flags);
  command->get_option("world")->description("the VRML97 world; for --mcap an output folder of peerd sim, or a capture");
  auto* const gltf = command->add_option("--gltf", flags->options.gltf,
                                         "write the world as it is drawn: glTF 2.0, binary (.glb); says what is left "
                                         "out");
  command->add_option("--at", flags->options.at_s, "when: the time of its TimeSensors [s] (default: 0)")
      ->needs(gltf)
      ->transform(number_in(kWorldTimes_s));
  const auto mcap = std::make_shared<McapOptions>();
  auto* const file = command->add_option("--mcap", mcap->file,
                                         "write poses, errors, contacts and scenes of a run or a capture: MCAP, for "
                                         "Foxglove and Rerun");
  file->excludes(gltf);
  command->add_option("--run", mcap->run, "which run of a sweep, from 1 (default: 1)")
      ->needs(file)
      ->transform(whole_number_in(1, kEventCountMax));
  command->add_option("--hz", mcap->hz, "poses of a second (default: 30)")
      ->needs(file)
      ->transform(whole_number_in(1, kViewHzMax));
  command
      ->add_option("--memory", mcap->memory_mib,
                   "MiB that they may take meanwhile; what does not fit is left out, and a line says so (default: "
                   "512)")
      ->needs(file)
      ->transform(whole_number_in(1, kSizeMax_mib));
  command->add_option("--size-max", mcap->size_max_mib, "MiB that a capture may have (default: 1024)")
      ->needs(file)
      ->transform(whole_number_in(1, kSizeMax_mib));
  command->add_option("--world-file", mcap->world, "where the world of a capture is now (default: where it was)")
      ->needs(file);
  return {command, [flags, mcap] {
            if (!mcap->file.empty()) {
              mcap->what = flags->world;
              mcap->json = flags->options.json;
              return run_mcap_export(*mcap, std::cout, std::cerr);
            }
            if (flags->options.gltf.empty()) return failed({"error: say --gltf FILE or --mcap FILE", kWrongUse});
            return run_export(flags->world, flags->options, std::cout, std::cerr);
          }};
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

// The network that `peerd ls` and `peerd join` ask.
struct AskFlags {
  std::string interface;
  bool ipv6 = false;

  [[nodiscard]] config::TransportSettings transport() const {
    config::TransportSettings settings;
    settings.interface = interface;
    if (ipv6) settings.group = "ff15::50:0";  // of which the family counts
    return settings;
  }
};

void add_ask_options(CLI::App& command, AskFlags& flags) {
  command.add_option("--interface", flags.interface,
                     "network interface, such as eth0 (default: the only one that can multicast, else lo)");
  command.add_flag("--ipv6", flags.ipv6, "ask by IPv6");
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
  command->add_option("world", flags->join.world, "the world's name, as peerd ls says (default: the only one)");
  command->add_option("--from", flags->join.from,
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
            flags->join.transport = flags->ask.transport();
            flags->join.key = {flags->run.key, flags->run.password};
            flags->join.open = flags->run.open;
            flags->run.interface = flags->ask.interface;
            flags->join.peer.sets = as_settings(flags->run, flags->join.peer);
            return run_join(flags->join);
          }};
}

Command add_invite(CLI::App& app) {
  const auto options = std::make_shared<InviteOptions>();
  CLI::App* const command =
      app.add_subcommand("invite", "prints the command that brings somebody else into a world; it has the world's key");
  command->footer("Exit codes: 0 good, 2 wrong use, 3 there is no key of that world");
  command->add_option("world", options->world, "the world's name, as peerd ls says")->required();
  command->add_option("--key", options->key, "the file of its key (default: this user's own of that world)");
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

Command add_replay(CLI::App& app) {
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
  return {command, [options] { return run_replay(*options); }};
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

// A run is of a scenario, or of chaos.
int run_sim_or_chaos(const CLI::App& command, const ScenarioOptions& options, ChaosOptions& chaos) {
  if (chaos.seeds.empty()) {
    if (options.scenario.empty()) {
      return failed({"error: scenario is required; see " + full_name(command) + " --help", kWrongUse});
    }
    return run_sim(options);
  }
  for (const char* other : {"scenario", "--config", "--set", "--seed", "--repeat", "--out", "--samples", "--capture"}) {
    if (command.get_option(other)->count() > 0) {
      return failed({std::string("error: ") + other + " is of a scenario; --chaos has none", kWrongUse});
    }
  }
  chaos.json = options.json;
  return run_chaos_seeds(chaos);
}

Command add_sim(CLI::App& app) {
  const auto options = std::make_shared<ScenarioOptions>();
  const auto chaos = std::make_shared<ChaosOptions>();
  CLI::App* const command = app.add_subcommand("sim", "a scenario on a simulated network, as fast as it goes");
  command->footer(exit_codes("an expectation failed, or the world has errors"));
  add_scenario_options(*command, *options);
  command->add_option("--capture", options->captures,
                      "a folder for all that each peer hears and sends: PEER.pcapng, of a sweep in run-NNN");
  command->add_flag("-v,--verbose", options->verbose, "print the peers' logs");
  command->get_option("scenario")->required(false);
  add_chaos_options(*command, *chaos);
  return {command, [command, options, chaos] { return run_sim_or_chaos(*command, *options, *chaos); }};
}

Command add_scenario(CLI::App& app) {
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
  return {command, [options] { return run_scenario(*options, std::filesystem::read_symlink("/proc/self/exe")); }};
}

Command add_doctor(CLI::App& app) {
  struct Flags {
    DoctorOptions doctor;
    RunFlags network;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* const command = app.add_subcommand("doctor", "whether a peer could reach others from here, and how");
  command->footer(
      "Exit codes: 0 a peer could reach others, 1 those on this computer only, 2 wrong use or configuration, 3 none");
  command->add_option("-c,--config", flags->doctor.config, "a scenario file, of which the table [transport] counts")
      ->transform(installed().scenario());
  command->add_option("--set", flags->doctor.sets, "KEY=VALUE over it, such as transport.ttl=4 (repeatable)")
      ->allow_extra_args(false);
  add_network_options(*command, flags->network);
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
                      "the VRML97 world that it began with (default: what the store keeps of it)");
  written->add_option("--out", flags->written.file, "the file to write (default: standard output)");
  return {command, [flags, check] {
            return *check ? run_store_check(flags->check, std::cout) : run_store_export(flags->written, std::cout);
          }};
}

Command add_help(CLI::App& app) {
  const auto names = std::make_shared<std::vector<std::string>>();
  CLI::App* const command = app.add_subcommand("help", "the help of a command, or this one");
  command->add_option("command", *names, "its name, such as sim or ctl key (default: that of peerd)");
  return {command, [names, &app] {
            const CLI::App* asked = &app;
            for (const std::string& name : *names) {
              const auto found = find_command(*asked, name);
              if (!found) return failed(found.error());
              asked = *found;
            }
            std::cout << help_of(*asked);
            return 0;
          }};
}

Command add_version(CLI::App& app) {
  return {app.add_subcommand("version", "the version of this program"), [] {
            std::cout << kVersion << '\n';
            return 0;
          }};
}

Command add_ctl(CLI::App& app) {
  struct Flags {
    CtlOptions ctl;
    KeyFlags key;
    PoseFlags pose;
    EditFlags edit;
    CtlCommands commands{};
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* const command = app.add_subcommand("ctl", "asks or tells a peer that runs on this computer");
  flags->commands = add_ctl_commands(*command, flags->ctl, flags->key, flags->pose, flags->edit);
  return {command, [flags] {
            const auto request = ctl_request(flags->commands, flags->key, flags->pose, flags->edit);
            if (!request) return failed(request.error());
            flags->ctl.request = *request;
            flags->ctl.follows = bool(*flags->commands.subscribe);
            return run_ctl(flags->ctl);
          }};
}

Command add_top(CLI::App& app) {
  const auto top = std::make_shared<TopOptions>();
  CLI::App* const command = app.add_subcommand("top", "shows a peer that runs on this computer, again and again");
  command->footer("Ends by q, a signal, or with the peer. Exit codes: 0 good, 2 wrong use, 3 no peer answers");
  auto* control =
      command->add_option("--control", top->socket, "the peer's control socket (default: that of the peer of --name)");
  command->add_option("--name", top->name, "the peer's name (default: the only one that this user runs)")
      ->excludes(control);
  command->add_option("--every", top->every_s, "seconds from one screen to the next (default: 1)")
      ->transform(number_in({0.1, 3600.0}));
  command->add_option("--count", top->count, "ends after so many screens (default: goes on)")
      ->transform(whole_number_in(1, std::numeric_limits<std::int64_t>::max()));
  return {command, [top] { return run_top(*top); }};
}

Command add_view(CLI::App& app) {
  const auto view = std::make_shared<ViewOptions>();
  view->listen = "127.0.0.1:0";
  CLI::App* const command =
      app.add_subcommand("view", "serves a page of a simulated run or a capture, or says where that of a peer is");
  command->footer(exit_codes("the capture or its world has errors"));
  auto* what =
      command->add_option("what", view->what,
                          "an output folder of peerd sim, a capture, or the control socket of a peer (default: "
                          "the socket of the peer of --name)");
  command->add_option("--name", view->name, "a peer's name (default: the only one that this user runs)")
      ->excludes(what);
  command->add_option("--listen", view->listen,
                      "ADDRESS:PORT of the page (default: 127.0.0.1:0, a port that the system chooses)");
  command->add_option("--run", view->run, "which run of a sweep, from 1 (default: 1)")
      ->transform(whole_number_in(1, kEventCountMax));
  command->add_option("--world", view->world, "where the world of a capture is now (default: where it was)");
  command->add_option("--hz", view->hz, "pictures that are kept of a second (default: 30)")
      ->transform(whole_number_in(1, kViewHzMax));
  command
      ->add_option("--memory", view->memory_mib,
                   "MiB that they may take; what does not fit is left out, and a line says so (default: 512)")
      ->transform(whole_number_in(1, kSizeMax_mib));
  command->add_option("--size-max", view->size_max_mib, "MiB that a capture may have (default: 1024)")
      ->transform(whole_number_in(1, kSizeMax_mib));
  return {command, [view] { return run_view(*view); }};
}

// A command line stands in the list of processes for all to see: the invitations in it are overwritten.
void hide_invitations(std::span<char*> words) {
  for (char* const word : words) {
    const std::size_t begin = std::string_view(word).find(seal::kInvitationBegin);
    if (begin == std::string_view::npos) continue;
    const std::size_t secret = begin + seal::kInvitationBegin.size();
    explicit_bzero(word + secret, std::string_view(word).size() - secret);
  }
}

// Says why a command line is refused. Without a command there is nothing to explain but the commands themselves.
int refuse(const CLI::App& app, const CLI::ParseError& error) {
  if (!lacks_command(app)) return failed(wrong_use(app, error));
  const CLI::App& command = innermost_command(app);
  std::cerr << help_of(command);
  return failed({"error: which command? " + full_name(command) + " needs one", kWrongUse});
}

int run(int argc, char** argv) {
  CLI::App app{"peerd keeps a shared 3D world alive between computers without a server", "peerd"};
  app.require_subcommand(1);
  app.set_version_flag("--version", kVersion);
  app.footer(exit_codes("a finding about the input") + ", 130 or 143 stopped by a signal");
  const std::span words(argv, static_cast<std::size_t>(argc));
  print_errors_as_json(std::ranges::find(words, std::string_view("--json")) != words.end());
  // The commands are in the order of the help.
  const std::array commands{add_run(app),    add_join(app),    add_invite(app), add_keygen(app), add_members(app),
                            add_ls(app),     add_record(app),  add_replay(app), add_sim(app),    add_scenario(app),
                            add_check(app),  add_collide(app), add_bake(app),   add_export(app), add_doctor(app),
                            add_ctl(app),    add_top(app),     add_view(app),   add_store(app),  add_help(app),
                            add_version(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    return refuse(app, error);
  }
  hide_invitations(words);
  const auto chosen = std::ranges::find_if(commands, [](const Command& command) { return command.app->parsed(); });
  assert(chosen != commands.end());
  return chosen->run();
}

// Runs the program. Whatever ends it is said in one sentence.
int run_or_say_why(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    return failed({std::string("error: ") + e.what(), kEnvironment});
  }
}

}  // namespace
}  // namespace peerd

int main(int argc, char** argv) {
  peerd::occupy_closed_streams();
  const int code = peerd::run_or_say_why(argc, argv);
  const auto lost = peerd::why_output_is_lost();
  if (!lost) return code;
  std::cerr << "error: standard output can't be written: " << *lost << '\n';
  return peerd::kEnvironment;
}
