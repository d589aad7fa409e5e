#include "peerd/config/shared_settings.hpp"

#include <array>
#include <cstdint>
#include <sstream>

#include <toml++/toml.h>

namespace peerd::config {
namespace {

// Tables and keys that are copied as they are.
constexpr std::array kShared{"world_name", "expansion", "replication", "decisions", "relay", "regions"};
constexpr std::array kMulticastWords{"auto", "always", "never"};  // by TransportSettings::multicast

}  // namespace

std::string shared_settings(const RunSettings& run) {
  const toml::table all = toml::parse(run.toml);  // what this program has written itself
  toml::table shared;
  for (const char* const key : kShared) {
    if (const toml::node* const node = all.get(key)) shared.insert(key, *node);
  }
  toml::table transport{{"group", run.transport.group},
                        {"group_pool", static_cast<std::int64_t>(run.transport.group_pool)},
                        {"ttl", static_cast<std::int64_t>(run.transport.ttl)},
                        {"multicast", kMulticastWords.at(run.transport.multicast)}};
  if (run.transport.port) transport.insert("port", static_cast<std::int64_t>(*run.transport.port));
  shared.insert("transport", transport);
  toml::table peers;
  for (const PeerSettings& peer : run.peers) {
    const PeerId id{peer.id};
    if (id != run.replication.decisions.server && id != run.replication.relay.through) continue;
    peers.insert(peer.name, toml::table{{"id", static_cast<std::int64_t>(peer.id)}});
  }
  if (!peers.empty()) shared.insert("peer", peers);
  std::ostringstream text;
  text << shared << '\n';
  return text.str();
}

}  // namespace peerd::config
