#pragma once
#include <string>
#include <vector>

#include "peerd/config/run_settings.hpp"

namespace peerd::config {

// The network settings that apply to datagrams from one peer to another: those of the link, else of the island that
// both are on, else of the network.
[[nodiscard]] const LinkSettings& link(const RunSettings& run, const std::string& from, const std::string& to);
// All settings of links that a run has: the network's, those within islands, and those between two peers.
[[nodiscard]] std::vector<LinkSettings> links_of(const RunSettings& run);

}  // namespace peerd::config
