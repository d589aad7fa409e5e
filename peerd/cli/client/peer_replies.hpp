#pragma once
#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "peerd/input/input_error.hpp"

namespace peerd {

// Sends one request of the control protocol to the peer that listens at `socket`, and returns its reply. A list that
// comes in pieces (objects, peers, conflicts) is asked for until it is whole. The error says that no peer of this
// version answers (exit code 3), or why the peer refuses (2).
[[nodiscard]] Result<nlohmann::ordered_json> ask_peer(const std::filesystem::path& socket, const std::string& request);

// Reads one reply and refuses one that reports an error.
[[nodiscard]] Result<nlohmann::ordered_json> read_reply(const std::filesystem::path& socket, const std::string& line);

}  // namespace peerd
