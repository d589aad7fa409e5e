#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>

#include "peerd/cli/shell/installed_files.hpp"

namespace peerd {

// A command of the program: its entry in the command line, and what runs it once that is parsed. `run` keeps the
// options alive that `app` writes to.
struct Command {
  CLI::App* app;
  std::function<int()> run;
};

// Limits that options of several commands share.
inline constexpr std::int64_t kSizeMax_mib = 1 << 20;
inline constexpr std::int64_t kEventCountMax = std::numeric_limits<std::int32_t>::max();
inline constexpr std::int64_t kViewHzMax = 240;

// The last line of a command's help. `finding` is what 1 means there.
[[nodiscard]] std::string exit_codes(const std::string& finding);

// The scenarios and worlds that are installed with this program.
[[nodiscard]] const InstalledFiles& installed();

}  // namespace peerd
