#include "peerd/lab/chaos/damaged_network.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::chaos {
namespace {

constexpr std::size_t kFlipsMax = 4;
constexpr double kTruncates = 0.3;  // else it flips bits

}  // namespace

std::uint16_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = bytes.size();  // the length stands in the header
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    sum += static_cast<std::uint64_t>(bytes[i]) << (i % 2 == 0 ? 8 : 0);
  }
  while (sum >> 16 != 0) sum = (sum & 0xFFFF) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

DamagedNetwork::DamagedNetwork(std::uint64_t seed, std::size_t peers, const LinkFaults& links)
    : peers_(peers), seed_(seed), cuts_(peers * peers), joined_(peers), random_(stream_of(seed, Stream::kDamage)) {
  set_links(links);
}

void DamagedNetwork::set_links(const LinkFaults& links) {
  damage_ = links.damage;
  links_.clear();
  for (std::size_t i = 0; i < peers_ * peers_; ++i) {
    links_.emplace_back(links.link, stream_of(seed_, Stream::kLink, changes_++).bits());
  }
}

void DamagedNetwork::cut(std::size_t from, std::size_t to, bool cuts) {
  int& count = cuts_[from * peers_ + to];
  count += cuts ? 1 : -1;
  assert(count >= 0);
}

void DamagedNetwork::mend_all() { std::ranges::fill(cuts_, 0); }

// Damage is of bytes that the checksum tells from those before: one in 65,536 that it would not tell is drawn again.
replication::Bytes DamagedNetwork::damaged(const replication::Bytes& datagram) {
  assert(!datagram.empty());
  for (;;) {
    replication::Bytes bytes = datagram;
    if (random_.chance(kTruncates)) {
      bytes.resize(random_.below(bytes.size()));
    } else {
      for (std::size_t flips = 1 + random_.below(kFlipsMax); flips > 0; --flips) {
        const std::size_t at = random_.below(bytes.size());
        bytes[at] ^= std::byte{1} << static_cast<int>(random_.below(8));
      }
    }
    if (checksum(bytes) != checksum(datagram)) return bytes;
  }
}

void DamagedNetwork::send(sim::VirtualTime now, std::size_t from, RegionId region, replication::Bytes datagram) {
  const auto whole = std::make_shared<const replication::Bytes>(std::move(datagram));
  for (std::size_t to = 0; to < peers_; ++to) {
    if (to == from || !joined_[to].contains(region)) continue;
    ++counters_.sent;
    if (cuts_[from * peers_ + to] > 0) {
      ++counters_.cut;
      continue;
    }
    const std::vector<Duration> delays = links_[from * peers_ + to].delays();
    counters_.lost += delays.empty() ? 1 : 0;
    counters_.repeated += delays.size() > 1 ? 1 : 0;
    for (const Duration delay : delays) {
      const bool damages = damage_ > 0.0 && random_.chance(damage_);
      counters_.damaged += damages ? 1 : 0;
      auto bytes = damages ? std::make_shared<const replication::Bytes>(damaged(*whole)) : whole;
      queue_.push({{now + delay, number_++, from, to, region, std::move(bytes)}, damages});
    }
  }
}

void DamagedNetwork::put_off(Arrival arrival, sim::VirtualTime until) {
  assert(until >= arrival.delivery.at);
  arrival.delivery.at = until;
  queue_.push(std::move(arrival));
}

DamagedNetwork::Arrival DamagedNetwork::take_next() {
  assert(!queue_.empty());
  Arrival next = queue_.top();
  queue_.pop();
  return next;
}

}  // namespace peerd::chaos
