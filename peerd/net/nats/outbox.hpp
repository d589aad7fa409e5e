#pragma once
#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/os/datagram_limits.hpp"

namespace peerd::nats {

// A datagram that is to leave.
struct Parcel {
  RegionId region;
  HostTime at;  // of send()
  std::size_t size = 0;
  std::array<std::byte, net::kMaxDatagramBytes> bytes;

  [[nodiscard]] std::span<const std::byte> datagram() const { return std::span(bytes).first(size); }
};

// A region that is to be subscribed to, or not any more.
struct RegionChange {
  RegionId region;
  bool joins;
};

// Hands datagrams and changes of regions from the io_context's thread over to the one that may wait for the network.
// Datagrams are bounded; changes are never lost.
class Outbox {
 public:
  // Datagrams that may wait. More than a tick ever sends at once; a worker that can't keep up loses the rest.
  static constexpr std::size_t kParcelsMax = 256;

  Outbox();

  // ---- of the io_context's thread; neither waits ----
  // False: there is no room. Precondition: at most kMaxDatagramBytes.
  [[nodiscard]] bool put(RegionId region, HostTime at, std::span<const std::byte> datagram);
  void change(RegionChange change);
  // Wakes who waits; what has been put waits for this.
  void flush();
  void stop();

  // ---- of the worker ----
  struct Taken {
    std::size_t parcels = 0;  // how many of `storage` are in use
    std::vector<Parcel> storage;
    std::vector<RegionChange> changes;
    bool stop = false;
    [[nodiscard]] std::span<const Parcel> all() const { return std::span(storage).first(parcels); }
  };
  // Waits until something is there, but no longer than `at_most`, and exchanges it for what was taken before.
  void take(Taken& taken, Duration at_most);
  [[nodiscard]] static Taken make_taken();

 private:
  std::mutex mutex_;
  std::condition_variable filled_;
  std::vector<Parcel> parcels_;  // kParcelsMax places
  std::size_t count_ = 0;
  std::vector<RegionChange> changes_;
  bool flushed_ = false, stop_ = false;
};

}  // namespace peerd::nats
