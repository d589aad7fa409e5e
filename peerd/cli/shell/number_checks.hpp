#pragma once
#include <cstdint>

#include <CLI/CLI.hpp>

#include "peerd/input/number.hpp"

namespace peerd {

// What an option that takes numbers passes to CLI::Option::transform(), so that nothing but finite numbers of the range
// gets in; anything else is wrong use, with a sentence.
[[nodiscard]] CLI::Validator number_in(NumberRange range);
// Numbers in hexadecimal digits become decimal ones. Without it, CLI11 takes 010 for 8 and -1 for 2^64 - 1.
[[nodiscard]] CLI::Validator whole_number_in(std::int64_t min, std::int64_t max);

}  // namespace peerd
