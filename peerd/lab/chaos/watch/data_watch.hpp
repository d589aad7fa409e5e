#pragma once
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "core/scene/scene.hpp"
#include "core/time.hpp"
#include "peerd/lab/chaos/watch/findings.hpp"
#include "peerd/lab/chaos/watch/operation_book.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::chaos {

// Watches what operations make of the scene and of the data at its nodes, which of them are lost, and what is undone.
class DataWatch {
 public:
  // Both outlive this.
  DataWatch(const OperationBook& book, Findings& findings) : book_(book), findings_(findings) {}

  void on_edit(const WatchedPeer& peer, const EditReport& report);
  void on_output(const WatchedPeer& peer, const replication::Output& output);
  // Checks what all peers have in common when everything has come to rest. `file`: the scene that all began with.
  void finish(double now_s, std::span<const WatchedPeer> all, const Scene* file);

 private:
  // The operations that peers have in the end, others are gone with those that held them, and what of them is undone
  // until the earliest of their clocks.
  struct Known {
    OperationBook book;
    std::set<replication::OperationId> undone;
    SimTime until = SimTime::max();
  };

  void check_same(double now_s, std::span<const WatchedPeer> all);
  void check_data(double now_s, const WatchedPeer& peer, const Known& known);
  void check_undone(double now_s, std::span<const WatchedPeer> all, const Scene& file, const Known& known);
  void check_conflicts(double now_s, std::span<const WatchedPeer> all, const Scene& file, const Known& known);

  const OperationBook& book_;
  Findings& findings_;
  std::map<std::size_t, std::map<replication::OperationId, std::string>> refused_;  // by life; empty: in force
};

}  // namespace peerd::chaos
