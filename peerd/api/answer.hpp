#pragma once
#include <string>
#include <string_view>

#include "peerd/peer_node.hpp"

namespace peerd::api {

struct Answer {
  std::string line;    // JSON, without its end
  bool leave = false;  // the peer was told to leave
};

// Does what one line asks of the peer. The node's outputs are to be drained after it.
[[nodiscard]] Answer answer(PeerNode& node, HostTime now, std::string_view request);

// A reply that says why nothing was done.
[[nodiscard]] std::string refusal(const std::string& sentence);

}  // namespace peerd::api
