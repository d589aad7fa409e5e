#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/daemon/open/peer_store.hpp"
#include "peerd/daemon/open/session_seal.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/peer/config/resolve.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/edits/log/log_signer.hpp"

namespace peerd {

// Tells a person about the input what is no error.
using WarnPerson = std::function<void(const std::string&)>;

// The PeerParts are all that a peer is made of, besides its clock and its network.
struct PeerParts {
  config::Scenario scenario;
  config::PeerSettings* settings = nullptr;  // of the scenario
  std::unique_ptr<const SharedWorld> shared;
  OpenedStore opened;
  replication::Author author;  // once the store is filled, as what follows
  std::unique_ptr<const replication::LogSigner> signer;
  config::PeerObjects objects;
  std::uint64_t session = 0;  // config::ReplicationSettings::session_hash

  [[nodiscard]] const config::RunSettings& run() const { return scenario.runs.front(); }
  // The name by which others find the world, of at most 63 printable bytes: what was configured, else that of its file.
  [[nodiscard]] std::string world_name(const PeerOptions& options) const;
};

[[nodiscard]] Result<config::Scenario> read_configuration(const PeerOptions& options);

// Reads the configuration and the world, and what this peer owns in it.
[[nodiscard]] Result<PeerParts> make_parts(const PeerOptions& options, const WarnPerson& warn);

// Opens the store, adds what was provided, and keeps the world itself and the peer's number there. `session_seal`
// outlives the parts.
[[nodiscard]] Result<void> fill_store(const PeerOptions& options, const keys::Identity& identity,
                                      const SessionSeal& session_seal, PeerParts& parts);

}  // namespace peerd
