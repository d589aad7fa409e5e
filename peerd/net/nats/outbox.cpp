#include "peerd/net/nats/outbox.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::nats {

Outbox::Outbox() : parcels_(kParcelsMax) {}

Outbox::Taken Outbox::make_taken() {
  Taken taken;
  taken.storage.resize(kParcelsMax);
  return taken;
}

bool Outbox::put(RegionId region, HostTime at, std::span<const std::byte> datagram) {
  assert(datagram.size() <= net::kMaxDatagramBytes);
  const std::scoped_lock lock(mutex_);
  if (count_ == parcels_.size()) return false;
  Parcel& parcel = parcels_[count_++];
  parcel.region = region;
  parcel.at = at;
  parcel.size = datagram.size();
  std::ranges::copy(datagram, parcel.bytes.begin());
  if (count_ == net::kBatch) {
    flushed_ = true;
    filled_.notify_one();
  }
  return true;
}

void Outbox::change(RegionChange change) {
  const std::scoped_lock lock(mutex_);
  changes_.push_back(change);
  flushed_ = true;
  filled_.notify_one();
}

void Outbox::flush() {
  const std::scoped_lock lock(mutex_);
  if (count_ == 0) return;
  flushed_ = true;
  filled_.notify_one();
}

void Outbox::stop() {
  const std::scoped_lock lock(mutex_);
  stop_ = true;
  filled_.notify_one();
}

void Outbox::take(Taken& taken, Duration at_most) {
  assert(taken.storage.size() == kParcelsMax);
  taken.changes.clear();
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, at_most, [this] { return flushed_ || stop_; });
  taken.storage.swap(parcels_);
  taken.parcels = std::exchange(count_, 0);
  taken.changes.swap(changes_);
  taken.stop = stop_;
  flushed_ = false;
}

}  // namespace peerd::nats
