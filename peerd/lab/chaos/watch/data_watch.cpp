#include "peerd/lab/chaos/watch/data_watch.hpp"

#include <algorithm>
#include <variant>

#include <spdlog/fmt/fmt.h>

#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd::chaos {
namespace {

using namespace replication;
using Losses = std::map<OperationId, std::optional<OperationId>>;  // by the operation that is lost, the winner

SimTime session_now(const WatchedPeer& peer) {
  const Peer& p = peer.node->peer();
  return p.clock().to_session(p.next_deadline());
}

Losses losses_of(const Conflicts& conflicts, SimTime now) {
  Losses all;
  for (const Conflict& each : conflicts.list(now)) {
    all.emplace(each.loser.second, each.winner ? std::optional(each.winner->second) : std::nullopt);
  }
  return all;
}

// The first loss that one of them has and the other has not, or has otherwise.
std::string difference(const Losses& a, const Losses& b) {
  const auto text = [](const Losses& losses, OperationId loser) {
    const auto at = losses.find(loser);
    if (at == losses.end()) return std::string("not lost");
    return at->second ? "lost by " + name_of(*at->second) : "lost by none that is known";
  };
  std::set<OperationId> losers;
  for (const Losses* some : {&a, &b}) {
    for (const auto& [loser, winner] : *some) losers.insert(loser);
  }
  const auto other = std::ranges::find_if(losers, [&](OperationId each) { return text(a, each) != text(b, each); });
  if (other == losers.end()) return "";
  return fmt::format("operation {} is {}, or {}", name_of(*other), text(a, *other), text(b, *other));
}

bool has_node(const Scene& scene, NodeId node) {
  return scene.document->ids.find(node, scene.document->nodes.size()).has_value();
}

std::string vrml_of(const Scene& scene) {
  const auto written = write_world(scene);
  return written ? written->text : "not written: " + written.error();
}

}  // namespace

void DataWatch::on_edit(const WatchedPeer& peer, const EditReport& report) {
  if (!report.operation) {
    if (is_undo(report.edit))
      findings_.count(fmt::format("{} refused: {}", to_string(report.edit.kind), report.refused));
    return;
  }
  const Operation* const operation = book_.find(*report.operation);
  if (operation == nullptr) return;
  if (const auto* undo = std::get_if<UndoOperation>(&operation->body)) {
    const Operation* const undone = book_.find({operation->id.author, undo->number});
    findings_.count(
        fmt::format("{} of {}", undo->redoes ? "redo" : "undo", undone == nullptr ? "nothing" : kind_of(undone->body)));
  } else if (const auto* set = std::get_if<SetData>(&operation->body)) {
    const bool is_there = peer.node->peer().data().find(set->node, set->key) != nullptr;
    findings_.count(!set->value ? "data removed" : is_there ? "data replaced" : "data set");
  } else {
    findings_.count(fmt::format("edit: {}", kind_of(operation->body)));
  }
}

void DataWatch::on_output(const WatchedPeer& peer, const Output& output) {
  if (const auto* edited = std::get_if<SceneEdited>(&output)) refused_[peer.life][edited->operation] = edited->refused;
}

void DataWatch::finish(double now_s, std::span<const WatchedPeer> all, const Scene* file) {
  if (all.empty()) return;
  Known known;
  for (const WatchedPeer& peer : all) known.until = std::min(known.until, session_now(peer));
  const OperationLogs& logs = all.front().node->peer().logs();
  for (const LogLength& log : logs.lengths()) known.book.follow(logs, log.author);
  const auto refused = [&](const WatchedPeer& peer, OperationId id) {
    const auto known_why = refused_[peer.life].find(id);
    return known_why != refused_[peer.life].end() && !known_why->second.empty();
  };
  known.undone = known.book.undone(known.until, [&](OperationId id) { return refused(all.front(), id); });
  for (const auto& [id, operation] : known.book.operations()) {
    if (!std::holds_alternative<UndoOperation>(operation.body) || operation.stamp > known.until) continue;
    for (const WatchedPeer& peer : all) {
      if (refused(peer, id) == refused(all.front(), id)) continue;
      findings_.violate(now_s, fmt::format("{} and {} do not agree on whether the undo {} counts", name_of(all.front()),
                                           name_of(peer), name_of(id)));
    }
    if (refused(all.front(), id)) findings_.count("undo that a lock keeps from its effect, or of nothing");
  }
  for (const auto& [id, operation] : known.book.operations()) {
    findings_.count(fmt::format("operation: {}", kind_of(operation.body)));
  }
  check_same(now_s, all);
  for (const WatchedPeer& peer : all) check_data(now_s, peer, known);
  if (file == nullptr) return;
  check_undone(now_s, all, *file, known);
  check_conflicts(now_s, all, *file, known);
}

void DataWatch::check_same(double now_s, std::span<const WatchedPeer> all) {
  const Peer& first = all.front().node->peer();
  const auto locks_of = [](const Peer& peer) {
    std::map<ObjectId, AuthorId> locks;
    for (const Lock& lock : peer.locks()) locks.emplace(lock.object, lock.author);
    return locks;
  };
  findings_.count("object locked at the end", first.locks().size());
  for (const WatchedPeer& peer : all) {
    if (locks_of(peer.node->peer()) == locks_of(first)) continue;
    findings_.violate(now_s, fmt::format("{} has other locks than {}", name_of(peer), name_of(all.front())));
  }
  const Losses losses = losses_of(first.conflicts(), session_now(all.front()));
  for (const auto& [loser, winner] : losses) {
    const Operation* const lost = book_.find(loser);
    const Operation* const by = winner ? book_.find(*winner) : nullptr;
    findings_.count(fmt::format("conflict: {} lost by {}", lost == nullptr ? "?" : kind_of(lost->body),
                                by == nullptr ? "none known" : kind_of(by->body)));
  }
  for (const WatchedPeer& peer : all) {
    const auto changes = peer.node->peer().data().changes_since(first.data());
    if (!changes.empty()) {
      findings_.violate(now_s,
                        fmt::format("{} has other data than {}: of node {}:{}, {}", name_of(peer), name_of(all.front()),
                                    changes.front().node.origin, changes.front().node.number, changes.front().key));
    }
    const std::string other = difference(losses, losses_of(peer.node->peer().conflicts(), session_now(peer)));
    if (other.empty()) continue;
    findings_.violate(now_s,
                      fmt::format("{} and {} list other conflicts: {}", name_of(all.front()), name_of(peer), other));
  }
}

// A value is that of the last operation in force, where its node is there.
void DataWatch::check_data(double now_s, const WatchedPeer& peer, const Known& known) {
  std::map<OperationKey, const SetData*> writes;
  for (const auto& [id, operation] : known.book.operations()) {
    const auto* const set = std::get_if<SetData>(&operation.body);
    const auto refused = refused_[peer.life].find(id);
    const bool is_done = refused != refused_[peer.life].end() && refused->second.empty() && !known.undone.contains(id);
    if (set != nullptr && is_done && operation.stamp <= known.until) writes.emplace(key_of(operation), set);
  }
  std::map<std::pair<NodeId, std::string>, const SetData*> last;
  for (const auto& [key, set] : writes) last[{set->node, set->key}] = set;
  for (const auto& [where, set] : last) {
    if (!has_node(peer.node->scene(), where.first)) continue;
    const std::string* const value = peer.node->peer().data().find(where.first, where.second);
    if ((value == nullptr) == !set->value && (value == nullptr || *value == *set->value)) continue;
    findings_.violate(now_s,
                      fmt::format("{} has {} at {} {}, and the last operation says {}", name_of(peer),
                                  value == nullptr ? "nothing" : *value, path_or_id(peer.node->scene(), where.first),
                                  where.second, set->value.value_or("nothing")));
  }
}

// All is as in a scene that never had what is undone, nor the undoing.
void DataWatch::check_undone(double now_s, std::span<const WatchedPeer> all, const Scene& file, const Known& known) {
  LivingScene replayed(file);
  for (const auto& [id, operation] : known.book.operations()) {
    const bool is_undo = std::holds_alternative<UndoOperation>(operation.body);
    if (!is_undo && !known.undone.contains(id) && operation.stamp <= known.until) replayed.add(operation);
  }
  findings_.count("operation left out of the replay", known.undone.size());
  std::map<OperationId, std::string> refused;
  while (const auto change = replayed.apply(known.until, known.until)) {
    for (const LivingScene::Outcome& outcome : change->outcomes) refused[outcome.id] = outcome.refused;
  }
  const std::string expected = vrml_of(*replayed.scene());
  for (const WatchedPeer& peer : all) {
    if (vrml_of(peer.node->scene()) != expected) {
      findings_.violate(now_s,
                        fmt::format("{} has another scene than one that never had what is undone", name_of(peer)));
    }
    if (!peer.node->peer().data().changes_since(replayed.data()).empty()) {
      findings_.violate(now_s,
                        fmt::format("{} has other data than a scene that never had what is undone", name_of(peer)));
    }
    for (const auto& [id, why] : refused) {
      const auto there = refused_[peer.life].find(id);
      if (there != refused_[peer.life].end() && there->second.empty() == why.empty()) continue;
      findings_.violate(
          now_s, fmt::format("{} says of operation {}: \"{}\", and all operations make it: \"{}\"", name_of(peer),
                             name_of(id), there == refused_[peer.life].end() ? "not known" : there->second, why));
    }
  }
}

// The conflicts are those of somebody who has come to know all operations at once.
void DataWatch::check_conflicts(double now_s, std::span<const WatchedPeer> all, const Scene& file, const Known& known) {
  LivingScene at_once(file);
  for (const auto& [id, operation] : known.book.operations()) at_once.add(operation);
  while (at_once.apply(known.until, known.until)) {
  }
  const Losses losses = losses_of(at_once.conflicts(), known.until);
  for (const WatchedPeer& peer : all) {
    const std::string other = difference(losses, losses_of(peer.node->peer().conflicts(), session_now(peer)));
    if (other.empty()) continue;
    findings_.violate(
        now_s, fmt::format("{} lists other conflicts than a peer that knows all at once: {}", name_of(peer), other));
  }
}

}  // namespace peerd::chaos
