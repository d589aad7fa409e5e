#include <iostream>
#include <memory>
#include <string>

#include <unistd.h>

#include "peerd/cli/commands/bake_command.hpp"
#include "peerd/cli/commands/check_command.hpp"
#include "peerd/cli/commands/collide_command.hpp"
#include "peerd/cli/commands/export_command.hpp"
#include "peerd/cli/commands/new_command.hpp"
#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/program/shared_options.hpp"
#include "peerd/cli/shell/number_checks.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/input/console/stop_signals.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd {
namespace {

// The world times that a world is asked at [s]. Beyond them a tick is lost in rounding.
constexpr NumberRange kWorldTimes_s{-1e12, 1e12};
constexpr NumberRange kTicksPerSecond{1e-6, 1e6};
constexpr std::string_view kFormats =
    "Formats (docs/reference/formats.md):\n"
    "  VRML97  everything: movement, interests, responses, owners\n"
    "  X3D     as VRML97, in XML and Classic VRML; nodes and fields that VRML97 has not are left out\n"
    "  glTF    nodes, meshes, materials, images, cameras, lights, animations by steps and straight lines; no skins,\n"
    "          morph targets or cubic splines\n"
    "  OBJ     groups, polygons, lines, points, materials; no unit, no axis, no normals\n"
    "  STL     solids and their facets; no unit, no axis, no colours\n"
    "  PLY     faces, strips, points, colours; no unit, no axis\n"
    "  OFF     faces and colours; no unit, no axis\n"
    "What a format cannot say stands in WORLD.peerd.toml beside the file, or in --collide, --unit and --up.";
constexpr std::uint32_t kTurnStepsMax = 100'000;

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
      ->add_option(
          "world", flags.world,
          "the world (VRML97, X3D, glTF, OBJ, STL, PLY, OFF), or the name of an installed one; - reads it from "
          "standard input")
      ->required()
      ->transform(installed().world());
  command->add_flag("--json", flags.options.json, "one JSON object");
  command
      ->add_option("--expansion", flags.options.reading.expansion,
                   "how many times as much as usual its files may hold, unpack and sweep to (default: 1)")
      ->transform(whole_number_in(1, kExpansionMax));
  command->add_flag("--lenient", flags.options.reading.lenient, kLenientHelp);
  add_format_options(*command, flags.options.reading.collide, flags.options.reading.unit, flags.options.reading.up);
  return command;
}

}  // namespace

Command add_new(CLI::App& app) {
  const auto options = std::make_shared<NewOptions>();
  CLI::App* const command = app.add_subcommand("new", "begins a world of your own, with a scenario of two peers in it");
  command->footer("Exit codes: 0 good, 2 wrong use, or a file is there already, 3 the files can't be written");
  command->add_option("folder", options->folder, "where; it is made where there is none")->required();
  command->add_option("--name", options->name, "of the world and its files (default: the folder's)");
  command->add_option(
      "--from", options->from,
      "a world's file of any format (VRML97, X3D, glTF, OBJ, STL, PLY, OFF): the folder gets a copy, with a side "
      "file that says what may meet what");
  return {command, [options] { return run_new(*options, std::cout); }};
}

Command add_check(CLI::App& app) {
  const auto flags = std::make_shared<WorldFlags<CheckOptions>>();
  CLI::App* const command = add_world_command(
      app, "check", "read a world; problems as FILE:LINE:COLUMN; statistics; polygons' defects", *flags);
  command->footer(exit_codes("the world has errors") + "\n\n" + std::string(kFormats));
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
  command->add_option("--engine", options.engine,
                      "the way to find collisions, NAME[,option=value..], such as kdop,k=14 (default: ours)");
  command->add_option(
      "--against", options.against,
      "ask another engine as well, and count the answers in which the two differ: touches that are none, "
      "and missed ones");
  const auto lists = std::make_shared<bool>(false);
  command->add_flag("--engines", *lists, "lists these ways, and asks nothing of a world");
  command->get_option("world")->required(false);
  return {command, [flags, lists] {
            CollideOptions& asked = flags->options;
            if (*lists) return list_engines(asked.json, std::cout);
            if (flags->world.empty()) return failed({"error: world is required; see peerd collide --help", kWrongUse});
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

Command add_volumes(CLI::App& app, const LabRuns& lab) {
  const auto flags = std::make_shared<WorldFlags<VolumesOptions>>();
  VolumesOptions& options = flags->options;
  CLI::App* const command = add_world_command(
      app, "volumes", "how tightly bounding volumes fit a world's Shapes, and how their hierarchies turn out", *flags);
  command->footer(exit_codes("the world has errors, or nothing that can be measured"));
  command->add_flag("--whole", options.whole, "all Shapes as one object, in the world's frame");
  command->add_option("--steps", options.steps, "rotations of each of seven full turns (default: 1000)")
      ->transform(whole_number_in(1, kTurnStepsMax));
  command->add_flag("--curve", options.curve, "the volumes at each rotation, too");
  command
      ->add_option("--hierarchy", options.hierarchies,
                   "measure a tree of k-DOPs, OPTION=VALUE[,..] of k, rule and threshold, such as k=18,rule=min-sum "
                   "(repeatable)")
      ->allow_extra_args(false);
  command->add_flag("--levels", options.levels, "the volume of each level of these trees, too");
  return {command, [flags, &lab] { return lab.volumes(flags->world, flags->options, std::cout, std::cerr); }};
}

Command add_bake(CLI::App& app) {
  const auto flags = std::make_shared<WorldFlags<BakeOptions>>();
  CLI::App* const command =
      add_world_command(app, "bake", "write the hierarchy files that a world's Shapes name", *flags);
  return {command, [flags] { return run_bake(flags->world, flags->options, std::cout, std::cerr); }};
}

Command add_export(CLI::App& app, const LabRuns& lab) {
  const auto flags = std::make_shared<WorldFlags<ExportOptions>>();
  CLI::App* const command =
      add_world_command(app, "export", "write a world, a run or a capture for other programs", *flags);
  command->get_option("world")->description(
      "the world (VRML97, X3D, glTF, OBJ, STL, PLY, OFF); for --mcap an output folder of peerd sim, or a capture");
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
  return {command, [flags, mcap, &lab] {
            if (!mcap->file.empty()) {
              mcap->what = flags->world;
              mcap->json = flags->options.json;
              return lab.mcap_export(*mcap, std::cout, std::cerr);
            }
            if (flags->options.gltf.empty()) return failed({"error: say --gltf FILE or --mcap FILE", kWrongUse});
            return run_export(flags->world, flags->options, std::cout, std::cerr);
          }};
}

}  // namespace peerd
