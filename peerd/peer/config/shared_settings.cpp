#include "peerd/peer/config/shared_settings.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <sstream>

#include <toml++/toml.h>

#include "peerd/input/toml_input.hpp"

namespace peerd::config {
namespace {

// Tables and keys that are copied as they are.
constexpr std::array kShared{"world_name", "expansion", "replication", "decisions", "relay", "regions", "collision"};
constexpr std::array kMulticastWords{"auto", "always", "never"};  // by net::TransportSettings::multicast

constexpr std::array kSharedTransport{"group", "group_pool", "ttl",  "multicast",
                                      "port",  "relays",     "nats", "nats_subject"};

// The servers of the one who gives the world, for who has none of its own; users and passwords are nobody else's.
toml::array servers_to_share(const net::NatsSettings& nats) {
  toml::array servers;
  for (const std::string& server : nats.servers) {
    if (const auto url = net::parse_server_url(server)) servers.push_back(url->shown());
  }
  return servers;
}

template <std::size_t kCount>
std::optional<std::string> other_key(const toml::table& table, const std::array<const char*, kCount>& keys) {
  for (const auto& [key, value] : table) {
    if (std::ranges::find(keys, key.str()) == keys.end()) return std::string(key.str());
  }
  return std::nullopt;
}

// The first key that is none of a shared configuration, in a table that may be missing.
template <std::size_t kCount>
std::optional<std::string> other_key_in(const toml::node* node, const std::string& name,
                                        const std::array<const char*, kCount>& keys) {
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) return name;
  const auto other = other_key(*node->as_table(), keys);
  return other ? std::optional(name + "." + *other) : std::nullopt;
}

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
  if (!run.transport.relays.empty()) {
    toml::array relays;
    for (const std::string& relay : run.transport.relays) relays.push_back(relay);
    transport.insert("relays", relays);
  }
  if (!run.transport.nats.servers.empty()) {
    transport.insert("nats", servers_to_share(run.transport.nats));
    transport.insert("nats_subject", run.transport.nats.subject);
  }
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

Result<void> check_shared(const std::string& text) {
  auto table = parse_toml(text, "the settings that were provided");
  if (!table) return std::unexpected(table.error());
  const toml::node* const peers = table->get("peer");
  std::optional<std::string> other = other_key_in(table->get("transport"), "transport", kSharedTransport);
  if (peers != nullptr && !peers->is_table()) other = "peer";
  if (peers != nullptr && peers->is_table()) {
    for (const auto& [name, peer] : *peers->as_table()) {
      if (!other) other = other_key_in(&peer, "peer." + std::string(name.str()), std::array{"id"});
    }
  }
  table->erase("transport");
  table->erase("peer");
  if (!other) other = other_key(*table, kShared);
  if (!other) return {};
  return std::unexpected(
      InputError{"error: the settings that were provided have \"" + *other + "\", which peers do not share", kFinding});
}

}  // namespace peerd::config
