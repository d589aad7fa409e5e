#pragma once
#include <optional>
#include <string>

namespace peerd {

// Takes the numbers of the standard streams that this program was started without (`peerd .. >&-`), before anything
// opens a file: that file would else get what is printed. What is written to them fails, and what is read ends.
void occupy_closed_streams();

// Passes all that was printed to the operating system. Returns the reason why standard output lacks a part of it; empty
// where nothing is lost.
[[nodiscard]] std::optional<std::string> why_output_is_lost();

}  // namespace peerd
