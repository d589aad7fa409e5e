#include "replication/objects/updates/update_repeater.hpp"

#include <algorithm>
#include <cassert>
#include <unordered_set>
#include <utility>

#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// Without acknowledgements, a state that has not been replaced for so long is taken to stay for a while.
constexpr Duration kUnreplacedFor = std::chrono::seconds(1);
// The most repetitions of a state with hellos; enough for three in ten lost (0.3^6 = 0.0007).
constexpr std::uint32_t kWithHellosMax = 5;
// The most copies of an update without which a receiver may know nothing: enough for one in five lost (0.2^4 = 0.0016).
constexpr std::uint32_t kCopiesToArrive = 4;

}  // namespace

UpdateRepeater::UpdateRepeater(const PeerConfig& config, const Membership& members, OwnObjects& own, bool acknowledged,
                               PeerCounters& counters)
    : config_(config), members_(members), own_(own), acknowledged_(acknowledged), counters_(counters) {}

bool UpdateRepeater::is_acknowledged_by_all(const OwnObject& own) const {
  return own.delivery.acknowledged_by.size() == members_.all().size();
}

void UpdateRepeater::before_update(OwnObject& own, SimTime t) const {
  assert(own.last_sent && t >= *own.last_sent);
  if (t - *own.last_sent < members_.acknowledged_within(config_.settled_hello_period)) return;
  for (const auto& [peer, member] : members_.all()) {
    if (!own.delivery.acknowledged_by.contains(peer)) own.delivery.unacknowledged_by.insert(peer);
  }
}

void UpdateRepeater::on_update(ObjectId object, OwnObject& own, const UpdateRecord& record) {
  assert(record.object == object && record.sequence == own.sequence);
  own.delivery.record = record;
  own.delivery.times_sent = 1;
  copy_later(object, own);
  own.delivery.times_with_hello = 0;
  own.delivery.sent_in.clear();
  own.delivery.acknowledged_by.clear();
}

void UpdateRepeater::note_sent(const UpdateRecord& record, std::uint32_t number) {
  OwnObject* const own = own_.find(record.object);
  if (own != nullptr && own->sequence == record.sequence) own->delivery.sent_in.push_back(number);
}

// The update is copied with the next copy(), as often as the loss then asks for.
void UpdateRepeater::copy_later(ObjectId object, OwnObject& own) {
  if (!std::exchange(own.delivery.copying, true)) copying_.push_back(object);
}

// The first copy goes at once in another datagram, the others with the ticks that follow, while nothing newer goes.
void UpdateRepeater::copy(std::vector<EncodedUpdate>& copies_due) {
  const double loss = members_.worst_loss_to_peers();
  const std::uint32_t usual = copies_against(loss, config_.policy.copies);
  const std::uint32_t to_arrive = copies_against(loss, std::max(config_.policy.copies, kCopiesToArrive));
  assert(usual >= 1 && to_arrive >= usual);
  if (to_arrive > copies_wanted_) {  // an update with enough copies so far may need more
    for (auto& [object, own] : own_) copy_later(object, own);
  }
  copies_wanted_ = to_arrive;
  std::ranges::sort(copying_);
  auto kept = copying_.begin();
  for (const ObjectId object : copying_) {
    OwnObject* const own = own_.find(object);
    if (own == nullptr) continue;  // another peer's by now
    Delivery& delivery = own->delivery;
    const std::uint32_t times = delivery.copy_until_received ? to_arrive : usual;
    if (delivery.record && delivery.times_sent < times) {
      ++delivery.times_sent;
      copies_due.emplace_back(*delivery.record, delivery.record->at);
      ++counters_.updates_repeated;
    }
    delivery.copying = delivery.record && delivery.times_sent < times;
    if (delivery.copying) *kept++ = object;
  }
  copying_.erase(kept, copying_.end());
}

// Whether a member's hello says that the last datagram with the object's update did not arrive.
bool UpdateRepeater::is_lost(const OwnObject& own) const {
  const Delivery& delivery = own.delivery;
  return !delivery.sent_in.empty() && std::ranges::any_of(members_.all(), [&](const auto& entry) {
    const auto& [peer, member] = entry;
    return !delivery.acknowledged_by.contains(peer) && member.echo.acknowledgement &&
           member.echo.acknowledgement->surely_lost(delivery.sent_in.back());
  });
}

// A lost state would stand wrong until the time threshold. It goes out again with the next hello where datagrams do
// get lost, and whenever a member's hello says that the last one was lost; where no hello says anything in time, as
// often as the loss asks for.
void UpdateRepeater::repeat(HostTime now, SimTime session_now, std::vector<EncodedUpdate>& updates_due) {
  const double loss = members_.worst_loss_to_peers();
  const bool lossy = copies_against(loss, 2) > 1;
  const std::uint32_t most = acknowledged_ ? kWithHellosMax : 1;
  const Duration patience = acknowledged_ ? members_.acknowledged_within(config_.settled_hello_period) : kUnreplacedFor;
  const Duration latency = members_.longest_latency();
  std::unordered_set<ObjectId> due_anyway;  // they go out for the first time just now
  for (const EncodedUpdate& u : updates_due) due_anyway.insert(u.record().object);
  for (auto& [object, own] : own_) {
    Delivery& delivery = own.delivery;
    if (!delivery.record || delivery.times_with_hello >= most || is_acknowledged_by_all(own)) continue;
    const bool first = delivery.times_with_hello == 0;
    const bool overdue = first ? lossy || session_now - *own.last_sent >= patience
                               : now - delivery.with_hello_at >= patience &&
                                     delivery.sent_in.size() < copies_against(loss, 1 + kWithHellosMax);
    if (!is_lost(own) && !overdue) continue;
    if (due_anyway.contains(object)) continue;
    if (session_now + latency - delivery.record->at > kUpdateAgeMax) {
      own.resend = true;  // nobody would take what is so old: the next tick publishes the state by then
      own_.check(object);
      continue;
    }
    ++delivery.times_with_hello;
    delivery.with_hello_at = now;
    updates_due.emplace_back(*delivery.record, delivery.record->at);
    ++counters_.updates_repeated;
  }
}

}  // namespace peerd::replication
