#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/lab/chaos/watch/findings.hpp"
#include "peerd/lab/chaos/watch/operation_book.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::chaos {

// Watches who owns what by operations. The epoch of an object's ownership is the stamp, and the id, of the last
// operation in force that has given it to somebody.
class OwnershipWatch {
 public:
  // Both outlive this.
  OwnershipWatch(const OperationBook& book, Findings& findings) : book_(book), findings_(findings) {}

  // An edit was asked of the peer.
  void on_edit(const WatchedPeer& peer, const EditReport& report);
  // The outputs of the last call have been read.
  void end_outputs();
  void on_output(double now_s, const WatchedPeer& peer, const replication::Output& output);
  // Checks what must hold at every time.
  void check(double now_s, const WatchedPeer& peer);
  void end_life(const WatchedPeer& peer);
  // Checks what all peers have in common when everything has come to rest.
  void finish(double now_s, std::span<const WatchedPeer> all);

 private:
  using Epochs = std::map<ObjectId, std::set<replication::OperationKey>>;  // those in force; the last one counts
  struct Published {
    WatchedPeer peer;
    ObjectId object;
    double at_s = 0.0;
  };

  void on_edited(double now_s, const WatchedPeer& peer, const replication::SceneEdited& edited);
  void on_given(const WatchedPeer& peer, const replication::ObjectGiven& given);
  void on_published(double now_s, const WatchedPeer& peer, ObjectId object);
  // The peer may have lost the object in the call whose outputs these are, after it has published it.
  void excuse(const WatchedPeer& peer, ObjectId object);
  void check_requests(double now_s, const WatchedPeer& peer);
  void check_epochs(double now_s, std::span<const WatchedPeer> all);
  void check_owners(double now_s, std::span<const WatchedPeer> all);

  const OperationBook& book_;
  Findings& findings_;
  std::map<std::size_t, std::set<replication::OperationId>> open_;  // requests of a life that are not answered yet
  std::map<std::size_t, std::set<replication::OperationId>> given_up_;
  std::map<std::size_t, Epochs> epochs_;  // by life
  std::map<std::pair<std::size_t, replication::OperationId>, bool> refused_;
  std::vector<Published> doubted_;  // published by one that is not the owner any more
};

}  // namespace peerd::chaos
