#include "peerd/cli/program/program.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

#include <string.h>  // explicit_bzero, which is no part of C++

#include <CLI/CLI.hpp>

#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/standard_streams.hpp"
#include "peerd/cli/shell/wrong_use.hpp"
#include "peerd/net/keys/invitation.hpp"

namespace peerd {
namespace {

// A command line stands in the list of processes for all to see: the invitations in it are overwritten.
void hide_invitations(std::span<char*> words) {
  for (char* const word : words) {
    const std::size_t begin = std::string_view(word).find(keys::kInvitationBegin);
    if (begin == std::string_view::npos) continue;
    const std::size_t secret = begin + keys::kInvitationBegin.size();
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

int run(int argc, char** argv, const LabRuns& lab) {
  CLI::App app{"peerd keeps a shared 3D world alive between computers without a server", "peerd"};
  app.require_subcommand(1);
  app.set_version_flag("--version", program_version());
  app.footer(exit_codes("a finding about the input") + ", 130 or 143 stopped by a signal");
  const std::span words(argv, static_cast<std::size_t>(argc));
  print_errors_as_json(std::ranges::find(words, std::string_view("--json")) != words.end());
  // The commands are in the order of the help.
  const std::array commands{
      add_new(app),           add_run(app),          add_join(app),   add_invite(app),      add_keygen(app),
      add_members(app),       add_ls(app),           add_record(app), add_replay(app, lab), add_sim(app, lab),
      add_scenario(app, lab), add_compare(app, lab), add_check(app),  add_collide(app),     add_volumes(app, lab),
      add_bake(app),          add_export(app, lab),  add_doctor(app), add_relay(app),       add_ctl(app),
      add_top(app),           add_view(app, lab),    add_store(app),  add_help(app),        add_version(app)};
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
int run_or_say_why(int argc, char** argv, const LabRuns& lab) {
  try {
    return run(argc, argv, lab);
  } catch (const std::exception& e) {
    return failed({std::string("error: ") + e.what(), kSystemFailed});
  }
}

}  // namespace

int run_program(int argc, char** argv, const LabRuns& lab) {
  occupy_closed_streams();
  const int code = run_or_say_why(argc, argv, lab);
  const auto lost = why_output_is_lost();
  if (!lost) return code;
  std::cerr << "error: standard output can't be written: " << *lost << '\n';
  return kSystemFailed;
}

}  // namespace peerd
