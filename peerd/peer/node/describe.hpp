#pragma once
#include <optional>
#include <span>

#include "core/scene/scene.hpp"
#include "peerd/peer/feed/pose_feeds.hpp"
#include "peerd/peer/node/awaited_peer.hpp"
#include "peerd/peer/node/log_line.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd {

// The log line that says which peers a peer waits for before motions begin; none of them: that it waits no more.
[[nodiscard]] LogLine describe_missing(std::span<const AwaitedPeer> missing);

// The log line of an output of the peer; none where it is not worth one: datagrams and retracted contacts.
[[nodiscard]] std::optional<LogLine> describe(const replication::Output& output, const Scene& scene);
[[nodiscard]] LogLine describe(const feed::Notice& notice);

}  // namespace peerd
