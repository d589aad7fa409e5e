#pragma once
#include <iosfwd>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/reader.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd {

// The object that a command prints with --json where it can't do what it was asked for, with the members that `peerd
// check` has too:
//   good    false
//   errors  [{file, line, column, message}]. Lines and columns (bytes) count from 1; both are 0, and `file` may be
//           empty, where no place is known.
[[nodiscard]] nlohmann::ordered_json error_json(const InputError& error);
// The errors of a world.
[[nodiscard]] nlohmann::ordered_json error_json(const ReadResult& result);

// Prints the object as one line.
void print_error_json(const nlohmann::ordered_json& json, std::ostream& out);

}  // namespace peerd
