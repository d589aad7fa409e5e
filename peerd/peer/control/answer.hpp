#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/peer/control/event_kind.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::control {

struct Answer {
  std::string line;                       // JSON without a line end; empty: no reply is wanted
  bool leave = false;                     // the request asks the peer to leave
  std::optional<EventKinds> subscribe{};  // the client wants these from now on, and no others
  bool viewer = false;                    // the request asks where the peer's page is, which its driver knows
};

// The parts of "status" that the driver of a peer adds.
struct More {
  std::map<std::string, std::uint64_t> counters;
  std::vector<std::string> troubles{};  // what keeps it from the others, in sentences
};
using AskMore = std::function<More()>;

// Executes one line of the control protocol at the peer. The caller drains the node's outputs afterwards. Unix time +
// `host_minus_wall` is the time of this host, for poses that name their time. "status" says what `more` knows, too;
// null: nothing.
[[nodiscard]] Answer answer(PeerNode& node, HostTime now, std::string_view request,
                            Duration host_minus_wall = Duration{0}, const AskMore& more = nullptr);

// A reply that says that a request was executed.
[[nodiscard]] std::string done_reply();
// A reply that says where the peer's page is; empty: it has none.
[[nodiscard]] std::string viewer_reply(const std::string& url);
// A reply that says why a request was not executed.
[[nodiscard]] std::string refusal(const std::string& sentence);

}  // namespace peerd::control
