#pragma once
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include <boost/system/error_code.hpp>

#include "peerd/input/input_error.hpp"

namespace peerd::control {

// Whether a peer listens at `path`, be it stopped or busy: no error. connection_refused: the socket of a dead peer.
[[nodiscard]] boost::system::error_code reach(const std::filesystem::path& path);

// Sends one request to the peer that listens at `path` and returns its reply, both without line ends. The error, with
// exit code 3, says that no peer answers.
[[nodiscard]] Result<std::string> ask(const std::filesystem::path& path, const std::string& request,
                                      std::chrono::milliseconds within = std::chrono::seconds(3));

// Sends one request and gives each line that comes, the reply first, to `on_line`, until that returns false or the peer
// closes the connection. The error, with exit code 3, says that no peer answers.
[[nodiscard]] Result<void> listen(const std::filesystem::path& path, const std::string& request,
                                  const std::function<bool(const std::string& line)>& on_line);

}  // namespace peerd::control
