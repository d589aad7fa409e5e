#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "peerd/input/input_error.hpp"

namespace peerd::control {

// The folder of default sockets, which is this user's alone: $XDG_RUNTIME_DIR/peerd; without that variable
// /run/user/UID/peerd, where the system has made /run/user/UID, else /tmp/peerd-UID.
[[nodiscard]] std::filesystem::path runtime_folder();

// Makes that folder. The error says why it can't be made, or whose it is.
[[nodiscard]] Result<void> make_runtime_folder();

// The default socket of a peer: NAME.sock, or NAME-ID.sock where another peer listens at the first.
[[nodiscard]] std::filesystem::path default_socket(const std::string& name, std::uint32_t id);

// Finds the socket for `peerd ctl` without --control: that of the named peer or, with an empty name, of the only peer
// that listens. The error, with exit code 3 where none does, names the peers that are there.
[[nodiscard]] Result<std::filesystem::path> find_socket(const std::string& peer);

// The sockets of all peers of this user that listen there, by their names.
[[nodiscard]] std::vector<std::filesystem::path> all_sockets();

}  // namespace peerd::control
