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

// The world of a command line: a file, or standard input where its path is "-".
[[nodiscard]] Result<std::unique_ptr<const WorldFile>> read_world_asked_for(const std::string& path,
                                                                            const WorldReading& reading);

// Reads a world for a command that uses its hierarchyFiles, and prints its problems. Gives a world with a scene, or
// else the exit code: 1 it has errors, 2 there is no such file, 3 it can't be read. `json` also gets the errors, as
// error_json has them; null: it doesn't.
[[nodiscard]] std::expected<std::unique_ptr<const WorldFile>, int> open_world(const std::string& path,
                                                                              const WorldReading& reading,
                                                                              std::ostream& err,
                                                                              std::ostream* json = nullptr);

// Prints the error, and with `json` also the object of error_json. Returns the exit code.
int print_error(const InputError& error, std::ostream& err, std::ostream* json);

}  // namespace peerd
