#pragma once
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "peerd/lab/chaos/watch/findings.hpp"
#include "peerd/lab/chaos/watch/operation_book.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::chaos {

// Watches that a message arrives once, at every peer that was there.
class MessageWatch {
 public:
  // Both outlive this.
  MessageWatch(const OperationBook& book, Findings& findings) : book_(book), findings_(findings) {}

  // The sender has sent it; these peers run, one of them the sender.
  void on_sent(const WatchedPeer& sender, replication::OperationId message, std::span<const WatchedPeer> all);
  void on_received(double now_s, const WatchedPeer& peer, const replication::MessageReceived& message);
  // Checks that what was sent has come to all that were there, when everything has come to rest.
  void finish(double now_s, std::span<const WatchedPeer> all);

 private:
  struct Received {
    std::set<replication::OperationId> all;
    std::map<replication::AuthorId, std::uint32_t> last;  // by number
  };

  const OperationBook& book_;
  Findings& findings_;
  std::map<replication::OperationId, std::set<std::size_t>> sent_;  // the lives that were connected to the sender then
  std::map<std::size_t, Received> received_;                        // by life
};

}  // namespace peerd::chaos
