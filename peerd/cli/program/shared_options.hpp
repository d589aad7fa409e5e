#pragma once
#include <string>

#include <CLI/CLI.hpp>

#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/daemon/open/run_flags.hpp"
#include "peerd/net/transport/transport_options.hpp"
#include "peerd/peer/config/peer_settings.hpp"

namespace peerd {

inline constexpr const char* kLenientHelp =
    "read on where the world departs from VRML97 and browsers read on, with a warning at each place";

// Adds --collide, --unit and --up, which count before the side file of the world.
void add_format_options(CLI::App& command, std::string& collide, std::string& unit, std::string& up);

// The network of a peer. The defaults are those of net::TransportSettings.
void add_network_options(CLI::App& command, RunFlags& flags);

// The options of a peer that no configuration describes, and of all others. `described` says of which peers --name is.
void add_own_options(CLI::App& command, PeerOptions& peer, RunFlags& flags, const std::string& described);

// In which format a command logs.
CLI::Option* add_log_option(CLI::App& command, LogFormat& format);

// The store of a peer; `by_default` says which it is without them.
void add_store_options(CLI::App& command, StoreOptions& store, const std::string& by_default);

// The network that `peerd ls` and `peerd join` ask.
struct AskFlags {
  std::string interface;
  bool ipv6 = false;

  [[nodiscard]] net::TransportSettings transport() const {
    net::TransportSettings settings;
    settings.interface = interface;
    if (ipv6) settings.group = net::kIpv6Group;  // of which the family counts
    return settings;
  }
};
void add_ask_options(CLI::App& command, AskFlags& flags);

}  // namespace peerd
