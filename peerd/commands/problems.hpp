#pragma once
#include <cstddef>
#include <expected>
#include <iosfwd>
#include <memory>
#include <string>

#include "core/scene/reader.hpp"
#include "peerd/input/world_file.hpp"

namespace peerd {

inline constexpr std::size_t kShownProblems = 20;  // errors and warnings, each

struct ProblemCount {
  std::size_t errors = 0, warnings = 0;
};

// Prints a world's problems as FILE:LINE:COLUMN with a caret: the first kShownProblems errors and as many warnings, so
// that many of one kind do not hide the other.
ProblemCount print_problems(const ReadResult& result, std::ostream& err);

// Reads a world and prints its problems. Gives a world with a scene, or else the exit code: 1 it has errors, 2 there is
// no such file, 3 it can't be read.
[[nodiscard]] std::expected<std::unique_ptr<const config::WorldFile>, int> open_world(
    const std::string& path, const config::WorldReading& reading, std::ostream& err);

// A number and its noun: "1 error", "2 errors".
[[nodiscard]] std::string counted(std::size_t count, const std::string& what);

}  // namespace peerd
