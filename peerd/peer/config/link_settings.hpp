#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "peerd/input/toml_input.hpp"

namespace peerd::config {

// One direction between two peers of a simulated network or of one by netem: the table [network], or
// [network.link.FROM.TO] over it.
struct LinkSettings {
  double latency_ms = 0.0;
  double jitter_ms = 0.0;   // added to the latency, uniform in [0, jitter]
  double loss = 0.0;        // probability of a datagram, as those below
  double loss_burst = 0.0;  // mean length of a run of lost datagrams; 0: independent losses
  double duplication = 0.0;
  double reordering =
      0.0;  // probability of being held back by another latency + jitter, so that later datagrams overtake

  // No datagram is under way for longer than this.
  [[nodiscard]] double longest_delay_ms() const { return (latency_ms + jitter_ms) * (reordering > 0.0 ? 2.0 : 1.0); }
};

// The carrier of datagrams between the islands of a run of real peers, each of which has a peer: network.via.
enum class Via : std::uint8_t {
  kNothing,      // the network itself
  kNats,         // a nats-server on each island; all are leaf nodes of the first one
  kNatsCluster,  // the same as one cluster
  kRelay,        // a peerd relay on each island, where its peer multicasts; all are below the first one
};

struct LinkKey {
  std::string_view name;
  double LinkSettings::*value;
  double max;  // range is 0 to max
};
inline constexpr double kLatencyMax_ms = 60'000.0;
inline constexpr std::array kLinkKeys{
    LinkKey{"latency_ms", &LinkSettings::latency_ms, kLatencyMax_ms},
    LinkKey{"jitter_ms", &LinkSettings::jitter_ms, kLatencyMax_ms},
    LinkKey{"loss", &LinkSettings::loss, 1.0},
    LinkKey{"loss_burst", &LinkSettings::loss_burst, 1e6},
    LinkKey{"duplication", &LinkSettings::duplication, 1.0},
    LinkKey{"reordering", &LinkSettings::reordering, 1.0},
};

// The new values of some of these keys.
using LinkChange = std::vector<std::pair<double LinkSettings::*, double>>;

inline LinkChange read_link_change(TomlReader& reader) {
  LinkChange change;
  for (const LinkKey& key : kLinkKeys) {
    std::optional<double> given;
    reader.read(key.name, given, 0.0, key.max);
    if (given) change.emplace_back(key.value, *given);
  }
  return change;
}

inline void change_link(LinkSettings& link, const LinkChange& change) {
  for (const auto& [key, value] : change) link.*key = value;
}

}  // namespace peerd::config
