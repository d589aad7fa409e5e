#include "replication/objects/ghosts/ghost_check.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "replication/physics/laws/composed_motion.hpp"
#include "replication/wire/codec.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// The age of a digest's instant is the longest latency that any peer publishes, and this for jitter and ticks: by then
// all peers have the updates and decisions of that instant.
constexpr Duration kDigestMargin = std::chrono::milliseconds(50);
// A peer makes a digest of every second instant of the grid, or of every one where datagrams get lost.
constexpr std::int64_t kDigestEvery = 2;
// Each question that finds nothing doubles the time until the next one, up to kAskedApartMost, so that false digests
// cost little. One that finds a difference, or twice kAskedApartMost without a question, brings it back to kAskedApart.
constexpr Duration kAskedApart = std::chrono::milliseconds(450), kAskedApartMost = std::chrono::seconds(8);
// An owner answers a peer about a group no more often, and no more peers in that time.
constexpr Duration kAnsweredApart = std::chrono::milliseconds(900);
constexpr std::size_t kAnsweredAtOnce = 8;
// An answer that comes later after the question, or a report that comes later after the answer, is of something else.
constexpr Duration kAnswerAge = std::chrono::seconds(2);
// Digests of one owner are compared no more often. They are at least kGhostGrid apart.
constexpr Duration kComparedApart = std::chrono::milliseconds(200);
// Header and time of an answer leave so much for states.
constexpr std::size_t kAnswerMax_bytes = kDatagramMax_bytes - 40;
// Peers that have only just met have not exchanged all states yet: a peer compares an owner's digests once they have
// come for kSettledAfter without a pause of kDigestPause.
constexpr Duration kSettledAfter = std::chrono::seconds(2), kDigestPause = std::chrono::seconds(2);
// A peer checks at this interval whether its next digest is due.
constexpr Duration kChecksApart = std::chrono::milliseconds(50);
// ctl and the page show a difference for this long.
constexpr Duration kShownFor = std::chrono::seconds(2);

}  // namespace

GhostCheck::GhostCheck(const PeerConfig& config, Membership& members, const Owners& owners, const SceneObjects& scene,
                       OwnObjects& own, Replica& replica, const Sight& sight, RegionSubscriptions& regions,
                       const ContactDecisions& decisions, Outbox& outbox, PeerCounters& counters)
    : config_(config),
      members_(members),
      owners_(owners),
      scene_(scene),
      own_(own),
      replica_(replica),
      sight_(sight),
      regions_(regions),
      decisions_(decisions),
      outbox_(outbox),
      counters_(counters) {}

// Ghosts of pairs that nobody here sees are not computed (Sight), and nothing that they say can be compared.
bool GhostCheck::knows_ghosts_at(SimTime t) const {
  return replica_.begun() && t >= replica_.begun_at() && t <= replica_.ghosts().advanced() &&
         t > replica_.ghosts().advanced() - MotionWorld::kHistory && sight_.pairs_put_off() == 0;
}

const GhostCheck::Sums& GhostCheck::sums_at(SimTime t) {
  assert(knows_ghosts_at(t));
  for (auto& [of, sums] : sums_) sums = {};  // their memory is used again
  sums_of_ = t;
  for (const auto& [object, owner] : owners_) {
    const RegionId region = regions_.cuts() ? regions_.region_of(object) : kWholeScene;
    if (regions_.cuts() && region == kWholeScene) continue;  // nobody has published it
    if (scene_.contains(object) || !replica_.receives(object)) continue;
    sums_[{owner, region}].add(object, replica_.ghost(object, t));
  }
  std::erase_if(sums_, [](const auto& each) { return each.second.empty(); });  // of who has nothing there any more
  return sums_;
}

Duration GhostCheck::digest_age() const { return members_.longest_latency() + kDigestMargin; }

Duration GhostCheck::digests_apart() const {
  const bool lossy = copies_against(members_.worst_loss_to_peers(), 2) > 1;
  return kGhostGrid * (lossy ? 1 : kDigestEvery);
}

void GhostCheck::on_tick(SimTime t) {
  if (std::exchange(life_, replica_.lives()) != replica_.lives()) {
    sums_of_.reset();
    sums_.clear();
    digested_ = checked_ = SimTime::min();
    received_.clear();
    differences_.clear();
  }
  if (t < checked_ + kChecksApart && t >= checked_ && !regions_.cuts()) return;
  checked_ = t;
  forget_old(t);
  // A digest of a region's objects says which these are, too: a datagram of a later tick would find others there.
  if (regions_.cuts()) outbox_.forget_riders();
  if (own_.size() == 0 || members_.all().empty()) return;
  // A peer that withholds updates for want of bytes sends no digest: the answers to questions would take more bytes.
  if (std::exchange(withheld_, counters_.updates_withheld) != counters_.updates_withheld) return;
  const SimTime at = floor_to(t - digest_age(), digests_apart());
  if (at <= digested_ || !knows_ghosts_at(at)) return;
  digested_ = at;
  const PeerId self = outbox_.self();
  for (const auto& [of, sums] : sums_at(at)) {
    if (of.first == self) outbox_.ride(of.second, {at, sums.groups()});
  }
}

void GhostCheck::forget_old(SimTime t) {
  const auto is_gone = [&](PeerId peer) { return !members_.contains(peer); };
  std::erase_if(differences_, [&](const auto& each) { return t - each.second.noticed > kShownFor; });
  std::erase_if(asked_, [&](const auto& each) { return is_gone(each.first); });
  std::erase_if(received_,
                [&](const auto& each) { return is_gone(each.first.first) || t - each.second.last > 2 * kDigestPause; });
}

GhostCheck::Digests& GhostCheck::note_digest(PeerId owner, RegionId region, SimTime t) {
  Digests& digests = received_.try_emplace({owner, region}, Digests{t, t}).first->second;
  if (t - digests.last > kDigestPause || t < digests.first) digests.first = t;
  digests.last = t;
  return digests;
}

void GhostCheck::on_digest(PeerId sender, RegionId region, const GhostDigest& digest, SimTime now) {
  if (!knows_ghosts_at(digest.at) || (regions_.cuts() && region == kWholeScene)) return;
  Digests& digests = note_digest(sender, region, digest.at);
  if (digest.at < std::max(digests.first, replica_.begun_at()) + kSettledAfter) return;
  const std::pair of{sender, regions_.cuts() ? region : kWholeScene};
  const auto same = [&] {
    const auto at = sums_.find(of);
    return at != sums_.end() && at->second.groups() == digest.groups;
  };
  // Records that have come since the sums were made may have changed them.
  if (sums_of_ == digest.at && same()) {
    ++counters_.ghost_checks;
    return;
  }
  if (now < digests.computed + kComparedApart && now >= digests.computed) return;
  digests.computed = now;
  ++counters_.ghost_checks;
  replica_.catch_up_ghosts();
  (void)sums_at(digest.at);
  if (same()) return;
  const auto [at, is_first] = asked_.try_emplace(sender, Asked{now, digest.at, kAskedApart});
  if (!is_first) {
    Asked& asked = at->second;
    const Duration since = now - asked.when;
    if (since >= Duration{0} && since < asked.wait) return;
    const bool is_again = since >= Duration{0} && since < 2 * kAskedApartMost;
    asked = {now, digest.at, is_again ? std::min<Duration>(2 * asked.wait, kAskedApartMost) : Duration{kAskedApart}};
  }
  const GhostSums& sums = sums_[of];
  for (std::size_t group = 0; group < kGhostGroups; ++group) {
    if (sums.of_group(group) == digest.groups[group]) continue;
    Message m = outbox_.blank();
    m.ghost_question = {sender, of.second, digest.at, static_cast<std::uint32_t>(group), sums.buckets_of(group)};
    ++counters_.ghost_questions;
    send(m);
  }
}

// The receiver has not confirmed the last update, and there was hardly time: it is repeated as any other that gets lost
// (UpdateRepeater).
bool GhostCheck::is_on_its_way(const OwnObject& own, PeerId receiver, SimTime now) const {
  if (regions_.cuts() || !own.last_sent) return false;  // updates to regions are not acknowledged
  const Duration patience = members_.acknowledged_within(config_.settled_hello_period);
  return !own.delivery.acknowledged_by.contains(receiver) && now - *own.last_sent < 2 * patience;
}

void GhostCheck::on_question(PeerId sender, const GhostQuestion& question, SimTime now) {
  if (question.owner != outbox_.self() || !knows_ghosts_at(question.at)) return;
  if (regions_.cuts() != (question.region != kWholeScene)) return;
  Answered& answered = answered_[question.group];
  std::erase_if(answered.peers,
                [&](const auto& each) { return now < each.second || now - each.second >= kAnsweredApart; });
  if (answered.peers.size() >= kAnsweredAtOnce || !answered.peers.emplace(sender, now).second) return;
  replica_.catch_up_ghosts();
  const auto is_meant = [&](ObjectId object) {
    return !scene_.contains(object) && ghost_group(object) == question.group &&
           (!regions_.cuts() || regions_.region_of(object) == question.region);
  };
  GhostSums sums;
  for (const auto& [object, own] : std::as_const(own_)) {
    if (is_meant(object)) sums.add(object, replica_.ghost(object, question.at));
  }
  const auto buckets = sums.buckets_of(question.group);
  std::vector<ObjectId> suspects;
  for (const auto& [object, own] : std::as_const(own_)) {
    const std::size_t bucket = ghost_bucket(object);
    if (is_meant(object) && buckets[bucket] != question.buckets[bucket]) suspects.push_back(object);
  }
  if (suspects.empty()) return;
  // Objects for which an answer has no room come first in the next one: one of these may be the one that differs.
  Message m = outbox_.blank();
  std::size_t used_bytes = 0;
  for (std::size_t k = 0; k < std::min(suspects.size(), kGhostAnswerMax); ++k) {
    const ObjectId object = suspects[answered.turn % suspects.size()];
    const bool in_ghosts = replica_.ghosts().has(object);
    const MotionModel model(in_ghosts ? replica_.ghosts().relative_at(object, question.at)
                                      : at_rest(replica_.model().scene->rigid_pose(object)));
    const UpdateRecord state{object,
                             std::max(1u, own_.at(object).sequence),
                             question.at,
                             model,
                             decisions_.last_on(object),
                             {},
                             in_ghosts ? replica_.model().carrier_of(object) : std::nullopt};
    if (acceptable(model.state)) {
      used_bytes += encoded_size_bytes(state, question.at);
      if (used_bytes > kAnswerMax_bytes) break;
      m.ghost_answer.states.push_back(state);
    }
    ++answered.turn;
    if (!is_on_its_way(own_.at(object), sender, now)) own_.republish(object);
  }
  ++counters_.ghost_answers;
  answered.last = now;
  send(m);
}

bool GhostCheck::has_lost_datagrams() const {
  return std::ranges::any_of(members_.all(), [](const auto& each) {
    return std::ranges::any_of(each.second.received, [](const auto& numbered) {
      const Received received = numbered.second.received();
      return received.run < std::min(received.highest, Received::kWindow);
    });
  });
}

// The owner and this peer predict contacts with different objects where the scene is cut, for they receive different
// regions.
bool GhostCheck::is_explained(PeerId owner, const UpdateRecord& state) const {
  if (regions_.cuts() || has_lost_datagrams() || decisions_.last_on(state.object) != state.decision) return true;
  const auto& sequences = members_.all().at(owner).last_sequence;
  const auto last = sequences.find(state.object);
  return std::max(1u, last == sequences.end() ? 0u : last->second) != state.sequence;
}

void GhostCheck::on_answer(PeerId sender, const GhostAnswer& answer, SimTime now) {
  const auto asked = asked_.find(sender);
  if (asked == asked_.end() || now - asked->second.when > kAnswerAge) return;
  if (answer.states.front().at != asked->second.instant) return;  // somebody else has asked
  replica_.catch_up_ghosts();
  Message m = outbox_.blank();
  for (const UpdateRecord& state : answer.states) {
    if (owners_.of(state.object) != sender || !knows_ghosts_at(state.at) || !replica_.receives(state.object)) continue;
    if (state.carrier && !replica_.model().may_carry(*state.carrier, state.object)) continue;
    const KinematicState& said = state.model.state;
    const KinematicState there = state.carrier ? composed(replica_.ghost(*state.carrier, state.at), said) : said;
    const KinematicState here = replica_.ghost(state.object, state.at);
    const double apart_m = (here.position - there.position).norm();
    const double distance_m = apart_m < kMagnitudeMax ? apart_m : kMagnitudeMax;  // nor is it NaN
    const double angle_rad = here.orientation.angularDistance(there.orientation);
    if (distance_m <= kSamePlace_m && angle_rad <= kSameAngle_rad) continue;  // it has become the same meanwhile
    // Two answers may be of one instant: each group is asked about apart, and others ask, too.
    const auto known = differences_.find(state.object);
    if (known != differences_.end() && known->second.at == state.at) continue;
    const bool explained = is_explained(sender, state);
    Member& owner = *members_.find(sender);
    ++(explained ? counters_.ghosts_differ_explained : counters_.ghosts_differ);
    ++(explained ? owner.ghosts_differ_explained : owner.ghosts_differ);
    differences_[state.object] = {distance_m, now, state.at};
    asked->second.wait = kAskedApart;
    outbox_.push(GhostDiffers{state.object, sender, outbox_.self(), state.at, distance_m, explained});
    if (m.ghost_reports.size() == kGhostReportsMax) continue;
    m.ghost_reports.push_back({state.object, static_cast<float>(distance_m)});
  }
  if (!m.ghost_reports.empty()) send(m);
}

void GhostCheck::on_reports(PeerId sender, std::span<const GhostReport> reports, SimTime now) {
  for (const GhostReport& report : reports) {
    const std::optional<SimTime>& answered = answered_[ghost_group(report.object)].last;
    if (!own_.contains(report.object) || !answered || now - *answered > kAnswerAge) continue;
    differences_[report.object] = {report.distance_m, now, now};
    ++counters_.ghosts_reported;
    outbox_.push(GhostDiffers{report.object, outbox_.self(), sender, now, report.distance_m, true});
  }
}

std::optional<double> GhostCheck::difference_m(ObjectId object, SimTime now) const {
  const auto at = differences_.find(object);
  if (at == differences_.end() || now - at->second.noticed > kShownFor) return std::nullopt;
  return at->second.distance_m;
}

void GhostCheck::send(Message& message) { (void)regions_.send_to_peers(message); }

}  // namespace peerd::replication
