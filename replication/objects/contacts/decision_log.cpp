#include "replication/objects/contacts/decision_log.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>
#include <utility>

#include "replication/objects/contacts/decision.hpp"

namespace peerd::replication {
namespace {

// The first entry that is not before that contact time and author, by which entries are ordered.
template <class Entries>
auto not_before(Entries& entries, SimTime contact, PeerId author) {
  const auto before = [](const DecisionLog::Entry& e, const std::pair<SimTime, PeerId>& key) {
    return std::pair(e.record.contact, e.author) < key;
  };
  return std::lower_bound(entries.begin(), entries.end(), std::pair(contact, author), before);
}

std::pair<ObjectId, ObjectId> two_of(const DecisionRecord& d) { return std::minmax({d.collider, d.collidee}); }

bool involves(const DecisionRecord& d, ObjectId object) { return d.collider == object || d.collidee == object; }

bool conflict(const DecisionLog::Entry& a, const DecisionLog::Entry& b) {
  if (a.author == b.author) return false;  // decisions of one peer follow each other
  const Duration apart = a.record.contact - b.record.contact;
  if (apart > DecisionLog::kSameCollision || -apart > DecisionLog::kSameCollision) return false;
  if (apart == Duration{0}) return true;
  return a.record.known < b.record.contact && b.record.known < a.record.contact;
}

// The rank of a decision in a conflict; the lowest rank wins.
auto rank(const DecisionLog::Entry& e) {
  return std::tuple(e.record.rule == DecisionRule::kId, e.author, e.record.contact);
}

}  // namespace

bool of_pair(const DecisionRecord& d, ObjectId a, ObjectId b) {
  return (d.collider == a && d.collidee == b) || (d.collider == b && d.collidee == a);
}

std::optional<std::vector<DecisionLog::Change>> DecisionLog::add(const DecisionRecord& record, PeerId author) {
  assert(author != kNobody && record.collider != record.collidee);
  if (find(record.contact, author, record.collider, record.collidee) != nullptr) return std::nullopt;
  auto place = not_before(entries_, record.contact, author);
  while (place != entries_.end() && place->record.contact == record.contact && place->author == author &&
         two_of(place->record) < two_of(record)) {
    ++place;
  }
  Entry& added = *entries_.insert(place, Entry{record, author, false, {}, 0, {}, {}});

  std::vector<Entry*> pair;
  bool conflicts = false;
  for (Entry& e : entries_) {
    if (!of_pair(e.record, record.collider, record.collidee)) continue;
    pair.push_back(&e);
    conflicts = conflicts || conflict(e, added);
  }
  if (!conflicts) {  // then no other decision changes either
    added.in_force = true;
    return std::vector{Change{record, author, true}};
  }
  assert(pair.size() >= 2);
  std::ranges::sort(pair, {}, [](const Entry* e) { return rank(*e); });
  std::map<PeerId, std::vector<const Entry*>> standing;  // by author: decisions of one author do not conflict
  std::vector<Change> changes;
  for (Entry* e : pair) {
    const bool in_force = std::ranges::none_of(standing, [&](const auto& of_one) {
      return of_one.first != e->author &&
             std::ranges::any_of(of_one.second, [&](const Entry* s) { return conflict(*s, *e); });
    });
    if (in_force) standing[e->author].push_back(e);
    if (in_force == e->in_force) continue;
    e->in_force = in_force;
    changes.push_back({e->record, e->author, in_force});
  }
  std::ranges::stable_sort(changes, {}, [](const Change& c) { return std::pair(c.in_force, c.record.contact); });
  return changes;
}

const DecisionLog::Entry* DecisionLog::find(SimTime contact, PeerId author, ObjectId a, ObjectId b) const {
  for (auto e = not_before(entries_, contact, author); e != entries_.end(); ++e) {
    if (e->record.contact != contact || e->author != author) return nullptr;
    if (of_pair(e->record, a, b)) return &*e;
  }
  return nullptr;
}

DecisionLog::Entry* DecisionLog::find(SimTime contact, PeerId author, ObjectId a, ObjectId b) {
  return const_cast<Entry*>(std::as_const(*this).find(contact, author, a, b));
}

bool DecisionLog::is_decided_by_another(SimTime contact, PeerId author, ObjectId a, ObjectId b,
                                        DecisionRule rule) const {
  for (auto e = not_before(entries_, contact, kNobody); e != entries_.end() && e->record.contact == contact; ++e) {
    if (e->in_force && e->author != author && e->record.rule == rule && of_pair(e->record, a, b)) return true;
  }
  return false;
}

bool DecisionLog::has_another(SimTime contact, PeerId author, ObjectId a, ObjectId b) const {
  for (auto e = not_before(entries_, contact, author); e != entries_.end(); ++e) {
    if (e->record.contact != contact || e->author != author) return false;
    if (!of_pair(e->record, a, b) && (involves(e->record, a) || involves(e->record, b))) return true;
  }
  return false;
}

std::size_t DecisionLog::count(PeerId author, ObjectId a, ObjectId b) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(entries_, [&](const Entry& e) { return e.author == author && of_pair(e.record, a, b); }));
}

void DecisionLog::forget_before(SimTime contact) {
  std::erase_if(entries_, [&](const Entry& e) { return e.record.contact < contact; });
}

void DecisionLog::forget(ObjectId object) {
  std::erase_if(entries_, [&](const Entry& e) { return involves(e.record, object); });
}

SimTime DecisionLog::last(ObjectId object) const {
  for (auto e = entries_.rbegin(); e != entries_.rend(); ++e) {
    if (e->in_force && involves(e->record, object)) return e->record.contact;
  }
  return SimTime{};
}

SimTime DecisionLog::last_before(ObjectId object, SimTime contact) const {
  for (auto e = entries_.rbegin(); e != entries_.rend(); ++e) {
    if (e->in_force && e->record.contact < contact && involves(e->record, object)) return e->record.contact;
  }
  return SimTime{};
}

const DecisionLog::Entry* DecisionLog::last_entry(ObjectId object) const {
  for (auto e = entries_.rbegin(); e != entries_.rend(); ++e) {
    if (e->in_force && changes_motion_of(object, e->record)) return &*e;
  }
  return nullptr;
}

SimTime DecisionLog::last(ObjectId a, ObjectId b) const {
  for (auto e = entries_.rbegin(); e != entries_.rend(); ++e) {
    if (e->in_force && of_pair(e->record, a, b)) return e->record.contact;
  }
  return SimTime{};
}

bool DecisionLog::overruled(ObjectId object, SimTime contact) const {
  return std::ranges::any_of(entries_, [&](const Entry& e) {
    return !e.in_force && e.record.contact == contact && involves(e.record, object);
  });
}

}  // namespace peerd::replication
