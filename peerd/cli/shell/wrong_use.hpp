#pragma once
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "peerd/input/input_error.hpp"

namespace peerd {

// The commands and options that a person may have meant are known to `program`, which has refused the words of a
// command line with `error`. The result says in one sentence which word is wrong, what was probably meant, and how to
// get help.
[[nodiscard]] InputError wrong_use(const CLI::App& program, const CLI::ParseError& error);

// Whether the command line lacks nothing but a command, such as `peerd` or `peerd ctl` alone.
[[nodiscard]] bool lacks_command(const CLI::App& program);

// The command that the words were parsed as so far: `peerd ctl` of `peerd ctl leav`.
[[nodiscard]] const CLI::App& innermost_command(const CLI::App& program);

// The help of a command, and its whole name: "peerd ctl key".
[[nodiscard]] std::string help_of(const CLI::App& command);
[[nodiscard]] std::string full_name(const CLI::App& command);

// The subcommand of that name; else the error names the one that was probably meant.
[[nodiscard]] Result<const CLI::App*> find_command(const CLI::App& command, const std::string& name);

}  // namespace peerd
