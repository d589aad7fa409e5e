#pragma once
#include <cstddef>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace peerd {

// A sample is what a peer says of itself at one time: its replies to "status", "peers" and "objects".
struct PeerSample {
  nlohmann::ordered_json status, peers, objects;
  double at_s = 0.0;  // when the status came, by any clock that does not run backwards [s]
};

struct ScreenSize {
  std::size_t rows = 24, columns = 80;
};

// A screen of the peer: session and clock, traffic, the other peers, drops, and its objects, those with the greatest
// ghost errors first and then the fastest. Rates are those between the two samples; without an earlier one, or where
// the peer has restarted in between, they are left out. At most `rows` lines, each of at most `columns` bytes; a last
// line counts the objects that have no room.
[[nodiscard]] std::string top_screen(const std::optional<PeerSample>& before, const PeerSample& now, ScreenSize size);

}  // namespace peerd
