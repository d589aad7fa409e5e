#include "peerd/cli/shell/wrong_use.hpp"

#include <algorithm>
#include <vector>

#include "core/suggestion.hpp"

namespace peerd {
namespace {

bool is_option(std::string_view word) { return word.size() > 1 && word.starts_with('-'); }

std::string did_you_mean_one_of(std::string_view word, const std::vector<std::string>& candidates) {
  Suggestion suggestion(word);
  for (const std::string& candidate : candidates) suggestion.consider(candidate);
  const auto meant = suggestion.best();
  return meant ? "; did you mean " + std::string(*meant) + "?" : "";
}

// The options of the command and of those that it is a part of, which take over what it doesn't know.
std::vector<std::string> options_of(const CLI::App* command) {
  std::vector<std::string> names;
  for (; command != nullptr; command = command->get_parent()) {
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

std::vector<std::string> commands_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

std::string no_command(const CLI::App& command, const std::string& name) {
  return full_name(command) + " has no command " + name + did_you_mean_one_of(name, commands_of(command));
}

std::string sentence(const CLI::App& command, const std::vector<std::string>& left_over, const CLI::ParseError& error) {
  const auto name = std::ranges::find_if_not(left_over, is_option);
  if (name != left_over.end() && !commands_of(command).empty()) return no_command(command, *name);
  if (left_over.empty()) return error.what();
  if (name == left_over.begin()) return full_name(command) + " takes no further word: " + *name;
  const std::string option = left_over.front().substr(0, left_over.front().find('='));
  return full_name(command) + " has no option " + option + did_you_mean_one_of(option, options_of(&command));
}

}  // namespace

const CLI::App& innermost_command(const CLI::App& program) {
  const CLI::App* command = &program;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().back();
  return *command;
}

std::string full_name(const CLI::App& command) {
  const CLI::App* const parent = command.get_parent();
  return (parent != nullptr ? full_name(*parent) + ' ' : "") + command.get_name();
}

std::string help_of(const CLI::App& command) {
  // CLI::App::help() would give the help of the subcommand that has been parsed.
  return command.get_formatter()->make_help(&command, full_name(command), CLI::AppFormatMode::Normal);
}

bool lacks_command(const CLI::App& program) {
  const CLI::App& command = innermost_command(program);
  return command.get_require_subcommand_min() > 0 && program.remaining(true).empty();
}

InputError wrong_use(const CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& command = innermost_command(program);
  return {"error: " + sentence(command, program.remaining(true), error) + "\nSee " + full_name(command) + " --help",
          kWrongUse};
}

Result<const CLI::App*> find_command(const CLI::App& command, const std::string& name) {
  for (const CLI::App* sub : command.get_subcommands({})) {
    if (sub->get_name() == name) return sub;
  }
  return std::unexpected(InputError{"error: " + no_command(command, name) + "\nSee " + full_name(command) + " --help"});
}

}  // namespace peerd
