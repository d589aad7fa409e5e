#include "peerd/lab/chaos/watch/ownership_watch.hpp"

#include <algorithm>
#include <variant>

#include <spdlog/fmt/fmt.h>

#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos {
namespace {

using namespace replication;

// A peer gives up at a tick: at the slowest rate of a run two of them are so far apart.
constexpr Duration kTwoTicks = std::chrono::milliseconds(100);

}  // namespace

void OwnershipWatch::on_edit(const WatchedPeer& peer, const EditReport& report) {
  if (!report.operation || !is_about_ownership(report.edit)) return;
  findings_.count(fmt::format("ownership: {}", config::to_string(report.edit.kind)));
  const auto state = peer.node->operation(*report.operation);
  if (state && state->asks_until) {
    findings_.count("request made");
    open_[peer.life].insert(*report.operation);
    return;
  }
  const Operation* const operation = book_.find(*report.operation);
  const auto* const give = operation == nullptr ? nullptr : std::get_if<GiveObject>(&operation->body);
  if (give == nullptr || give->owner == kNobody || give->before == give->owner) return;
  findings_.count(give->before == kNobody ? "object taken from nobody" : "object taken from a peer that is gone");
}

void OwnershipWatch::end_outputs() {
  for (const auto& [peer, object, at_s] : doubted_) {
    findings_.violate(at_s, fmt::format("{} has published object {}:{}, which it says is another's", name_of(peer),
                                        object.origin, object.number));
  }
  doubted_.clear();
}

void OwnershipWatch::on_output(double now_s, const WatchedPeer& peer, const Output& output) {
  if (const auto* edited = std::get_if<SceneEdited>(&output)) {
    on_edited(now_s, peer, *edited);
  } else if (const auto* given = std::get_if<ObjectGiven>(&output)) {
    on_given(peer, *given);
  } else if (const auto* published = std::get_if<replication::Published>(&output)) {
    on_published(now_s, peer, published->object);
  } else if (const auto* seen = std::get_if<ContactSeen>(&output)) {
    excuse(peer, seen->contact.collider);
    excuse(peer, seen->contact.collidee);
  } else if (const auto* overruled = std::get_if<Overruled>(&output)) {
    excuse(peer, overruled->collider);
    excuse(peer, overruled->collidee);
  } else if (const auto* conflict = std::get_if<OwnershipConflict>(&output)) {
    excuse(peer, conflict->object);
  } else if (const auto* way = std::get_if<FounderGaveWay>(&output)) {
    excuse(peer, way->object);
  }
}

void OwnershipWatch::on_published(double now_s, const WatchedPeer& peer, ObjectId object) {
  if (peer.node->peer().owner(object) != peer.node->peer().id()) doubted_.push_back({peer, object, now_s});
}

void OwnershipWatch::excuse(const WatchedPeer& peer, ObjectId object) {
  std::erase_if(doubted_, [&](const Published& each) { return each.peer.life == peer.life && each.object == object; });
}

void OwnershipWatch::on_given(const WatchedPeer& peer, const ObjectGiven& given) {
  findings_.count("object given");
  excuse(peer, given.object);
}

// What takes the epoch from an operation that had it is an earlier one that came later, or the object is gone.
void OwnershipWatch::on_edited(double now_s, const WatchedPeer& peer, const SceneEdited& edited) {
  const Operation* const operation = book_.find(edited.operation);
  const auto* const give = operation == nullptr ? nullptr : std::get_if<GiveObject>(&operation->body);
  if (give == nullptr) return;
  const bool is_refused = !edited.refused.empty();
  refused_[{peer.life, edited.operation}] = is_refused;
  auto& in_force = epochs_[peer.life][give->object];
  const OperationKey key = key_of(*operation);
  if (!is_refused) {
    if (!in_force.empty() && key < *in_force.rbegin()) findings_.count("ownership: an earlier operation came later");
    in_force.insert(key);
    return;
  }
  if (in_force.erase(key) == 0) {
    findings_.count("ownership: another peer was earlier");
    return;
  }
  const bool is_known_why = edited.refused.find("owns it by then") == std::string::npos ||
                            std::ranges::any_of(in_force, [&](const OperationKey& other) { return other < key; });
  findings_.count("ownership taken back by an earlier operation");
  if (is_known_why) return;
  findings_.violate(now_s, fmt::format("{} goes back from operation {}, which gave object {}:{} to peer {}: {}",
                                       name_of(peer), name_of(edited.operation), give->object.origin,
                                       give->object.number, give->owner.value, edited.refused));
}

void OwnershipWatch::check(double now_s, const WatchedPeer& peer) { check_requests(now_s, peer); }

void OwnershipWatch::check_requests(double now_s, const WatchedPeer& peer) {
  const HostTime host = peer.node->next_deadline();  // its last tick was before that
  for (auto at = given_up_[peer.life].begin(); at != given_up_[peer.life].end();) {
    const bool is_late = peer.node->operation(*at)->applied;
    if (is_late) findings_.count("request granted after its time");
    at = is_late ? given_up_[peer.life].erase(at) : std::next(at);
  }
  auto& open = open_[peer.life];
  for (auto at = open.begin(); at != open.end();) {
    const OperationState state = peer.node->operation(*at).value();
    const bool is_over = state.applied || !state.refused.empty();
    if (!is_over && *state.asks_until + kTwoTicks < host) {
      findings_.violate(now_s, fmt::format("{} has asked for {} by operation {}, and after {} it has no answer",
                                           name_of(peer), state.edit.path, name_of(*at), "2 s it has not given up"));
    }
    if (is_over) {
      const bool timed_out = state.refused == "its owner has not answered";
      findings_.count(state.applied ? "request granted" : timed_out ? "request timed out" : "request refused");
      if (timed_out) given_up_[peer.life].insert(*at);
    }
    at = is_over ? open.erase(at) : std::next(at);
  }
}

void OwnershipWatch::end_life(const WatchedPeer& peer) {
  findings_.count("request open when its peer went", open_[peer.life].size());
  open_.erase(peer.life);
  given_up_.erase(peer.life);
  std::erase_if(doubted_, [&](const Published& each) { return each.peer.life == peer.life; });
}

void OwnershipWatch::finish(double now_s, std::span<const WatchedPeer> all) {
  end_outputs();
  if (all.empty()) return;
  for (const WatchedPeer& peer : all) check_requests(now_s, peer);
  check_epochs(now_s, all);
  check_owners(now_s, all);
}

void OwnershipWatch::check_epochs(double now_s, std::span<const WatchedPeer> all) {
  std::set<ObjectId> objects;
  for (const WatchedPeer& peer : all) {
    for (const auto& [object, keys] : epochs_[peer.life]) objects.insert(object);
  }
  for (const ObjectId object : objects) {
    const auto& first = epochs_[all.front().life][object];
    for (const WatchedPeer& peer : all) {
      const auto& keys = epochs_[peer.life][object];
      if (keys == first) continue;
      const auto text = [](const auto& some) { return some.empty() ? "none" : name_of(some.rbegin()->second); };
      findings_.violate(
          now_s, fmt::format("{} has operation {} as the epoch of object {}:{}, and {} {}", name_of(peer), text(keys),
                             object.origin, object.number, name_of(all.front()), text(first)));
    }
  }
}

// Goes through all operations in their order once more. Why else one of them is refused, the first peer says: what it
// gives is not in the scene then.
void OwnershipWatch::check_owners(double now_s, std::span<const WatchedPeer> all) {
  std::map<OperationKey, const GiveObject*> gives;
  for (const auto& [id, operation] : book_.operations()) {
    const auto* const give = std::get_if<GiveObject>(&operation.body);
    if (give != nullptr && refused_.contains({all.front().life, id})) gives.emplace(key_of(operation), give);
  }
  std::map<ObjectId, PeerId> owners;
  for (const auto& [key, give] : gives) {
    const auto owner = owners.find(give->object);
    const bool is_anothers = owner != owners.end() && owner->second != kNobody && owner->second != give->before;
    for (const WatchedPeer& peer : all) {
      const auto refused = refused_.find({peer.life, key.second});
      if (refused == refused_.end() || refused->second || !is_anothers) continue;
      findings_.violate(
          now_s, fmt::format("{} lets operation {} give what another peer owns", name_of(peer), name_of(key.second)));
    }
    if (!is_anothers && !refused_.at({all.front().life, key.second})) owners[give->object] = give->owner;
  }
  const auto is_here = [&](PeerId id) {
    return std::ranges::any_of(all, [&](const WatchedPeer& peer) { return peer.node->peer().id() == id; });
  };
  for (const auto& [object, owner] : owners) {
    for (const WatchedPeer& peer : all) {
      if (!is_here(owner) || !peer.node->scene().contains(object)) continue;
      const PeerId there = peer.node->peer().owner(object);
      if (there == owner) continue;
      findings_.violate(now_s,
                        fmt::format("{} is peer {}'s by operations, and for {} it is peer {}'s",
                                    path_or_id(peer.node->scene(), object), owner.value, name_of(peer), there.value));
    }
    findings_.count("owner by operations judged");
  }
}

}  // namespace peerd::chaos
