#include <cstdint>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/motion/key_codes.hpp"
#include "peerd/cli/client/ctl_command.hpp"
#include "peerd/cli/client/top_command.hpp"
#include "peerd/cli/commands/view_command.hpp"
#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/shell/number_checks.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/peer/feed/pose_feed.hpp"

namespace peerd {
namespace {

constexpr double kQuaternionMax = 2.0;  // of one component; the peer checks their norm
constexpr std::int64_t kKeyCodeMax = std::numeric_limits<std::int32_t>::max();

// The key of `peerd ctl key`, with the modifiers that are held down.
struct KeyFlags {
  std::string name;
  bool shift = false, control = false, alt = false, meta = false, keypad = false, release = false;
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
  commands.key->add_flag("--release", key.release, "lets go of it, in place of pressing it");
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
  const auto request = [&](std::int32_t value, std::int32_t state) {
    nlohmann::json json{{"do", "key"}, {"value", value}, {"state", state}};
    if (key.release) json["release"] = true;
    return json_line(json);
  };
  if (key.value) return request(*key.value, key.state);
  const auto named = find_key(
      key.name, {.shift = key.shift, .control = key.control, .alt = key.alt, .meta = key.meta, .keypad = key.keypad});
  if (!named) return std::unexpected(InputError{"error: " + named.error()});
  return request(named->value, named->state);
}

}  // namespace

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

Command add_view(CLI::App& app, const LabRuns& lab) {
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
  return {command, [view, &lab] { return run_view(*view, lab.view_recorded); }};
}

}  // namespace peerd
