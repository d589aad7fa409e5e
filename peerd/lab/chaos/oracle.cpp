#include "peerd/lab/chaos/oracle.hpp"

#include <algorithm>
#include <cassert>
#include <variant>

#include <spdlog/fmt/fmt.h>

#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd::chaos {
namespace {

using namespace replication;

// Outcomes of the last seconds may be on their way still.
constexpr Duration kOutcomesOpen = std::chrono::seconds(5);
constexpr Duration kCalmAfter = std::chrono::seconds(2);
// An operation of so long ago takes effect later than it says (OperationKeeper).
constexpr Duration kLateMax = std::chrono::seconds(3);
// Operations in time take effect with the tick of their stamp.
constexpr Duration kLate = std::chrono::milliseconds(150);

std::string text_of(const Scene& scene) {
  const auto written = write_world(scene);
  std::string text = written ? written->text : "not written: " + written.error();
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectId id = scene.id_of(i);
    text += fmt::format("{}:{} ", id.origin, id.number);
  }
  const vrml::Document& document = *scene.document;
  for (std::uint32_t i = 0; i < document.nodes.size(); ++i) {
    const NodeId id = document.ids.id_of(i);
    text += fmt::format("{}:{} ", id.origin, id.number);
  }
  return text;
}

std::string difference(const std::string& a, const std::string& b) {
  const auto at = std::ranges::mismatch(a, b);
  const auto from = [](const std::string& text, auto it) {
    const auto offset = static_cast<std::size_t>(it - text.begin());
    std::string part = text.substr(offset - std::min<std::size_t>(offset, 30), 80);
    std::ranges::replace(part, '\n', ' ');
    return part;
  };
  return fmt::format("\"{}\" and \"{}\"", from(a, at.in1), from(b, at.in2));
}

bool is_finite(const KinematicState& s) {
  return s.position.allFinite() && s.velocity.allFinite() && s.acceleration.allFinite() &&
         s.orientation.coeffs().allFinite() && s.angular_velocity_body.allFinite();
}

bool same_bits(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.orientation.coeffs() == b.orientation.coeffs() && a.angular_velocity_body == b.angular_velocity_body;
}

}  // namespace

Oracle::Oracle(std::size_t hosts, bool trusts_datagrams) : trusts_datagrams_(trusts_datagrams), life_of_host_(hosts) {}

Oracle::Life& Oracle::life_of(std::size_t host) {
  assert(life_of_host_[host].has_value());
  return lives_[*life_of_host_[host]];
}

std::vector<const Oracle::Life*> Oracle::alive() const {
  std::vector<const Life*> all;
  for (const Life& life : lives_) {
    if (life.node != nullptr) all.push_back(&life);
  }
  return all;
}

std::string Oracle::name_of(const Life& life) const { return fmt::format("peer {}", life.host + 1); }

void Oracle::begin_life(std::size_t host, const PeerNode& node) {
  assert(!life_of_host_[host]);
  life_of_host_[host] = lives_.size();
  Life& life = lives_.emplace_back();
  life.host = host;
  life.node = &node;
  if (trusts_datagrams_ && !node.peer().logs().lengths().empty()) watch_stored(watched(life));
}

// What the peer's store has made of the scene before the peer began, it does not say: the watches hear what the file
// and these operations make.
void Oracle::watch_stored(const WatchedPeer& peer) {
  assert(file_ != nullptr);
  const OperationLogs& logs = peer.node->peer().logs();
  OperationBook stored;
  for (const LogLength& log : logs.lengths()) {
    // An author's later life writes anew what was never stored, and so never sent.
    const auto author = author_host_.find(log.author);
    if (author != author_host_.end() && author->second == peer.host) book_.cut(logs, log.author);
    book_.follow(logs, log.author);
    stored.follow(logs, log.author);
  }
  LivingScene living(*file_);
  for (const auto& [id, operation] : stored.operations()) living.add(operation);
  const auto change = living.apply(SimTime::max(), SimTime::max());
  assert(change);
  for (const LivingScene::Outcome& outcome : change->outcomes) {
    const Output edited = SceneEdited{outcome.id, stored.find(outcome.id)->stamp, outcome.refused};
    ownership_.on_output(0.0, peer, edited);
    data_.on_output(peer, edited);
  }
}

void Oracle::end_life(std::size_t host) {
  Life& life = life_of(host);
  on_input(host);
  count_all(*life.node);
  ownership_.end_life(watched(life));
  life.node = nullptr;
  life.outcomes.clear();
  life_of_host_[host].reset();
}

WatchedPeer Oracle::watched(const Life& life) const {
  return {static_cast<std::size_t>(&life - lives_.data()), life.host, life.node};
}

std::vector<WatchedPeer> Oracle::all_watched() const {
  std::vector<WatchedPeer> all;
  for (const Life* life : alive()) all.push_back(watched(*life));
  return all;
}

// What peers do with datagrams that damage has changed means nothing.
void Oracle::watch_edit(const WatchedPeer& peer, const EditReport& report) {
  if (!trusts_datagrams_) return;
  if (report.operation) book_.follow(peer.node->peer().logs(), report.operation->author);
  ownership_.on_edit(peer, report);
  data_.on_edit(peer, report);
  const bool is_message = report.edit.kind == config::SceneEdit::Kind::kSend && report.operation;
  if (is_message) messages_.on_sent(peer, *report.operation, all_watched());
}

void Oracle::watch_output(double now_s, const WatchedPeer& peer, const Output& output) {
  if (!trusts_datagrams_) return;
  const OperationLogs& logs = peer.node->peer().logs();
  if (const auto* grown = std::get_if<LogGrown>(&output)) book_.follow(logs, grown->range.author);
  if (const auto* edited = std::get_if<SceneEdited>(&output)) book_.follow(logs, edited->operation.author);
  ownership_.on_output(now_s, peer, output);
  data_.on_output(peer, output);
  if (const auto* message = std::get_if<MessageReceived>(&output)) messages_.on_received(now_s, peer, *message);
}

void Oracle::on_edit(std::size_t host, const EditReport& report) {
  watch_edit(watched(life_of(host)), report);
  if (!report.operation) return count("edits refused at once");
  ++operations_;
  const AuthorId author = report.operation->author;
  const auto [at, is_new] = author_host_.try_emplace(author, host);
  assert(at->second == host && "no two hosts are one author");
  note_written(author, life_of(host).node->peer().logs().length(author));
  on_input(host);
}

// A later life of an author has what its store has, which may be less than was written.
void Oracle::note_written(AuthorId author, std::uint64_t bytes) {
  std::uint64_t& most = written_[author];
  most = std::max(most, bytes);
}

void Oracle::on_stored(std::size_t host, OperationId last) {
  assert(!author_host_.contains(last.author) || author_host_.at(last.author) == host);
  stored_[last.author] = last.number;
}

void Oracle::count(const SimulatedDisk::Counters& disk) {
  count("disk written", disk.writes);
  count("disk synchronised", disk.synchronised);
  count("disk: a write done in part", disk.torn);
  count("disk: a change lost with the power", disk.lost);
  count("disk: a write refused, full", disk.refused_full);
  count("disk: a change that failed", disk.refused_error);
}

void Oracle::on_key(const KeyReport& report) {
  for (const KeyReport::Change& change : report.changes) {
    count(change.refused.empty() ? "key moves an object" : "key refused");
  }
}

void Oracle::on_input(std::size_t host) {
  ownership_.end_outputs();
  Life& life = life_of(host);
  const PeerCounters& counters = life.node->peer().counters();
  const std::uint64_t taken = counters.operations + counters.operations_in;
  if (taken == life.taken) return;
  life.taken = taken;
  const OperationLogs& logs = life.node->peer().logs();
  for (const LogLength& log : logs.lengths()) {
    std::uint32_t& last = life.last[log.author];
    const std::uint32_t now = logs.last(log.author).number;
    if (now == last) continue;
    last = now;
    const auto author = author_host_.find(log.author);
    if (author != author_host_.end() && !life_of_host_[author->second]) count("repaired without the author");
  }
}

// A peer writes operations by itself, too: nobody has anything of a log before its author.
void Oracle::on_growth(std::size_t host, const OperationRange& grown) {
  if (trusts_datagrams_) author_host_.try_emplace(grown.author, host);
  const auto author = author_host_.find(grown.author);
  if (author != author_host_.end() && author->second == host) note_written(grown.author, grown.to);
}

void Oracle::on_output(double now_s, std::size_t host, const Output& output) {
  Life& life = life_of(host);
  watch_output(now_s, watched(life), output);
  if (const auto* edited = std::get_if<SceneEdited>(&output)) {
    on_edited(life, *edited);
  } else if (const auto* grown = std::get_if<LogGrown>(&output)) {
    on_growth(host, grown->range);
  } else if (const auto* held = std::get_if<OperationHeld>(&output)) {
    held_.emplace(held->operation, now_s);
    const bool is_held = std::ranges::any_of(lives_, [&](const Life& other) {
      const auto last = other.last.find(held->operation.author);
      return &other != &life && last != other.last.end() && last->second >= held->operation.number;
    });
    if (!is_held && trusts_datagrams_) {
      violate(now_s,
              "operation " + chaos::name_of(held->operation) + " is said to be held, and no other peer ever had it");
    }
  } else if (const auto* seen = std::get_if<ContactSeen>(&output)) {
    on_contact(life, *seen);
  } else if (const auto* overruled = std::get_if<Overruled>(&output)) {
    life.outcomes.erase({overruled->contact, std::minmax(overruled->collider, overruled->collidee)});
    count("decision overruled");
  } else if (const auto* differs = std::get_if<GhostDiffers>(&output)) {
    on_difference(now_s, life, *differs);
  } else if (std::holds_alternative<ContactsRetracted>(output)) {
    count("contacts retracted");
  } else if (std::holds_alternative<ObjectOrphaned>(output)) {
    count("object orphaned");
  } else if (const auto* lost = std::get_if<PeerLost>(&output)) {
    count(lost->left_gracefully ? "peer left" : "peer lost");
  } else if (const auto* joined = std::get_if<PeerJoined>(&output)) {
    count(joined->restarted ? "peer restarted unnoticed" : "peer joined");
  } else if (std::holds_alternative<HostSuspended>(output)) {
    count("host suspended");
  } else if (const auto* stepped = std::get_if<ClockStepped>(&output)) {
    count(stepped->same_session ? "clock stepped in its session" : "sessions merged");
  } else if (std::holds_alternative<OsClockDoubted>(output)) {
    count("OS clock doubted");
  } else if (std::holds_alternative<OwnershipConflict>(output)) {
    count("ownership conflict");
  } else if (std::holds_alternative<IdInUse>(output)) {
    count("id in use");
  } else if (const auto* met = std::get_if<LimitMet>(&output)) {
    count("limit met");
    // Operations may wait for their time where a session's clock was ahead.
    if (trusts_datagrams_ && met->limit != replication::MemberLimit::kOperationAhead) {
      violate(now_s, fmt::format("peer {} has met a limit of members: {}", met->peer.value,
                                 replication::to_string(met->limit)));
    }
  } else if (std::holds_alternative<BodiesOverlap>(output)) {
    count("bodies overlap");
  }
}

void Oracle::on_edited(Life& life, const SceneEdited& edited) {
  const bool is_refused = !edited.refused.empty();
  const auto [before, is_first] = life.refused.try_emplace(edited.operation, is_refused);
  if (!is_first) {
    if (before->second && !is_refused) count("operation does what it says after all");
    if (!before->second && is_refused) count("operation undone by an earlier one");
    before->second = is_refused;
    return;
  }
  if (is_refused) count("operation changes nothing");
  const Peer& peer = life.node->peer();
  const Duration late = peer.clock().to_session(peer.next_deadline()) - edited.at;
  if (late > kLateMax) {
    count("operation later than 3 s");
  } else if (late > kLate) {
    count("operation late");
  }
}

void Oracle::on_contact(Life& life, const ContactSeen& seen) {
  if (seen.kind != ContactKind::kDecided && seen.kind != ContactKind::kApplied) return;
  const ContactEvent& c = seen.contact;
  life.outcomes[{c.at, std::minmax(c.collider, c.collidee)}] = {c.collider, c.normal};
}

void Oracle::add(const PeerLog& log, const PeerLog::ObjectSample& sample) {
  if (is_finite(sample.state) && sample.shown.position.allFinite() && sample.shown.orientation.coeffs().allFinite())
    return;
  violate(
      to_seconds(sample.true_at.time_since_epoch()),
      fmt::format("peer {} has object {}:{} at no number", log.peer.value, sample.object.origin, sample.object.number));
}

void Oracle::check(double now_s) {
  for (const Life* life : alive()) {
    if (trusts_datagrams_) ownership_.check(now_s, watched(*life));
    const OperationLogs& logs = life->node->peer().logs();
    if (logs.ahead_bytes() > OperationLogs::kAheadMax_bytes) {
      violate(now_s, fmt::format("{} keeps {} bytes behind gaps", name_of(*life), logs.ahead_bytes()));
    }
    if (!trusts_datagrams_) continue;
    for (const LogLength& log : logs.lengths()) {
      const auto written = written_.find(log.author);
      if (written == written_.end() || log.bytes > written->second) {
        violate(now_s, fmt::format("{} holds {} bytes of the log of {}, who wrote {}", name_of(*life), log.bytes,
                                   log.author.value, written == written_.end() ? 0 : written->second));
      }
    }
  }
}

bool Oracle::is_one_world() const {
  const auto all = alive();
  for (const Life* life : all) {
    const Peer& peer = life->node->peer();
    if (peer.members().count() + 1 != all.size()) return false;
    if (peer.logs().lengths() != all.front()->node->peer().logs().lengths()) return false;
  }
  std::string first;
  for (const Life* life : all) {
    const std::string text = text_of(life->node->scene());
    if (life == all.front()) first = text;
    if (text != first) return false;
  }
  return true;
}

void Oracle::begin_calm() {
  for (const Life* life : alive()) {
    const HostTime host = life->node->peer().next_deadline();  // about now
    if (!life->node->peer().clock().synchronised()) continue;
    const SimTime session = life->node->peer().clock().to_session(host) + kCalmAfter;
    calm_since_ = std::max(calm_since_.value_or(session), session);
  }
}

void Oracle::finish(double now_s) {
  for (const Life* life : alive()) count_all(*life->node);
  if (!trusts_datagrams_) return;
  check_logs(now_s);
  check_held(now_s);
  check_stored(now_s);
  check_scenes(now_s);
  check_owners(now_s);
  check_outcomes(now_s);
  const auto all = all_watched();
  ownership_.finish(now_s, all);
  data_.finish(now_s, all, file_);
  messages_.finish(now_s, all);
  measure_ghosts();
}

void Oracle::check_logs(double now_s) {
  const auto all = alive();
  for (const Life* life : all) {
    const Peer &peer = life->node->peer(), &first = all.front()->node->peer();
    if (peer.members().count() + 1 != all.size()) {
      violate(now_s,
              fmt::format("{} knows {} other peers of {}", name_of(*life), peer.members().count(), all.size() - 1));
    }
    for (const auto& [author, written] : written_) {
      const OperationRange whole{author, 0, std::max(written, std::uint64_t{1})};
      if (const char* why = peer.logs().unreadable(author)) {
        violate(now_s, fmt::format("{} can't read the log of {}: {}", name_of(*life), author.value, why));
      }
      if (peer.logs().length(author) != first.logs().length(author)) {
        violate(now_s, fmt::format("{} holds {} bytes of the log of {}, and {} {} of {}", name_of(*life),
                                   peer.logs().length(author), author.value, name_of(*all.front()),
                                   first.logs().length(author), written));
      } else if (!std::ranges::equal(peer.logs().bytes(whole), first.logs().bytes(whole))) {
        violate(now_s,
                fmt::format("{} holds another log of {} than {}", name_of(*life), author.value, name_of(*all.front())));
      }
    }
  }
}

void Oracle::check_held(double now_s) {
  for (const auto& [operation, since_s] : held_) {
    const auto holds = [&](const Life& life) {
      const auto last = life.last.find(operation.author);
      return last != life.last.end() && last->second >= operation.number;
    };
    const auto all = alive();
    const auto holder = std::ranges::find_if(all, [&](const Life* life) { return holds(*life); });
    if (holder == all.end()) {
      count("all holders crashed");
      continue;
    }
    for (const Life* life : all) {
      if (life->node->peer().logs().last(operation.author).number >= operation.number) continue;
      violate(now_s, fmt::format("{} has lost operation {}, held since {:.3f} s, which {} has", name_of(*life),
                                 chaos::name_of(operation), since_s, name_of(**holder)));
    }
  }
}

// Everybody is here, with what each store has.
void Oracle::check_stored(double now_s) {
  for (const auto& [author, number] : stored_) {
    for (const Life* life : alive()) {
      if (life->node->peer().logs().last(author).number >= number) continue;
      violate(now_s, fmt::format("{} has lost operation {}, which its author's store had", name_of(*life),
                                 chaos::name_of({author, number})));
    }
  }
}

void Oracle::check_scenes(double now_s) {
  const auto all = alive();
  std::string first;
  for (const Life* life : all) {
    const std::string text = text_of(life->node->scene());
    if (life == all.front()) {
      first = text;
    } else if (text != first) {
      violate(now_s, fmt::format("{} and {} have other scenes: {}", name_of(*all.front()), name_of(*life),
                                 difference(first, text)));
    }
  }
}

void Oracle::check_owners(double now_s) {
  const auto all = alive();
  const auto is_here = [&](PeerId id) {
    return std::ranges::any_of(all, [&](const Life* life) { return life->node->peer().id() == id; });
  };
  for (const Life* life : all) {
    const Scene& scene = life->node->scene();
    for (const auto& [object, owner] : life->node->peer().owners()) {
      if (owner != kNobody && !is_here(owner)) {
        violate(now_s, fmt::format("{} has peer {} as the owner of {}, which is not here", name_of(*life), owner.value,
                                   path_or_id(scene, object)));
      }
      for (const Life* other : all) {
        const PeerId there = other->node->peer().owner(object);
        if (there == owner) continue;
        violate(now_s, fmt::format("{} is owned by {} for {}, and by {} for {}", path_or_id(scene, object), owner.value,
                                   name_of(*life), there.value, name_of(*other)));
      }
    }
  }
}

// Once the network has healed, whatever a peer shows elsewhere than its owner believes must have a reason.
void Oracle::on_difference(double now_s, const Life& life, const GhostDiffers& differs) {
  if (differs.owner == life.node->peer().id()) return;  // who shows it says why
  count(differs.explained ? "ghost differs, explained" : "ghost differs");
  if (differs.explained || !trusts_datagrams_ || !calm_since_ || differs.at < *calm_since_) return;
  violate(now_s, fmt::format("{} shows {} {:.3g} m from where its owner believes at session time {} ns", name_of(life),
                             path_or_id(life.node->scene(), differs.object), differs.distance_m,
                             differs.at.time_since_epoch().count()));
}

void Oracle::check_outcomes(double now_s) {
  if (!calm_since_) return;
  const auto all = alive();
  std::set<Contact> contacts;
  SimTime until = SimTime::max();
  for (const Life* life : all) {
    const Peer& peer = life->node->peer();
    until = std::min(until, peer.clock().to_session(peer.next_deadline()) - kOutcomesOpen);
    for (const auto& [contact, outcome] : life->outcomes) contacts.insert(contact);
  }
  for (const Contact& contact : contacts) {
    if (contact.first < *calm_since_ || contact.first > until) continue;
    count("contact of two peers judged");
    const Outcome* first = nullptr;
    for (const Life* life : all) {
      const auto known = life->outcomes.find(contact);
      const auto what = [&](const char* says) {
        const Scene& scene = life->node->scene();
        return fmt::format("{} {} of {} and {} at session time {} ns", name_of(*life), says,
                           path_or_id(scene, contact.second.first), path_or_id(scene, contact.second.second),
                           contact.first.time_since_epoch().count());
      };
      if (known == life->outcomes.end()) {
        violate(now_s, what("has no outcome of the contact"));
      } else if (first == nullptr) {
        first = &known->second;
      } else if (known->second.normal != first->normal || known->second.collider != first->collider) {
        violate(now_s, what("has another outcome of the contact"));
      }
    }
  }
}

// An object that moves apart at two peers meets other things there.
void Oracle::measure_ghosts() {
  const auto all = alive();
  if (all.empty()) return;
  SimTime t = SimTime::max();
  for (const Life* life : all) {
    const Peer& peer = life->node->peer();
    t = std::min(t, peer.clock().to_session(peer.next_deadline()) - std::chrono::milliseconds(500));
  }
  for (const auto& [object, owner] : all.front()->node->peer().owners()) {
    const KinematicState first = all.front()->node->peer().ghost(object, t);
    const bool same = std::ranges::all_of(all, [&](const Life* life) {
      return life->node->scene().contains(object) && same_bits(life->node->peer().ghost(object, t), first);
    });
    count(same ? "ghosts equal to the bit" : "ghosts differ");
  }
}

void Oracle::count_all(const PeerNode& node) {
  const PeerCounters& c = node.peer().counters();
  const OperationExchange::Counters e = node.peer().exchange_counters();
  count("decision", c.decisions);
  count("decision by fallback", c.decisions_fallback);
  count("contact held for another", c.contacts_held);
  count("contact refuted", c.contacts_refuted);
  count("contact too late to decide", c.contacts_too_late);
  count("range asked for", e.ranges_requested);
  count("question suppressed", e.requests_suppressed);
  count("answer cancelled", e.answers_cancelled);
  count("answer dropped, queue full", e.answers_dropped);
  count("clock contradiction", c.clock_contradictions);
  count("model changed", c.models_changed);
  for (const auto& [reason, times] : c.drops) count("dropped: " + reason, times);
}

}  // namespace peerd::chaos
