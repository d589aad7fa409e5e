#pragma once
#include <cstddef>
#include <optional>

#include "core/time.hpp"
#include "replication/settings/policy/publish_policy.hpp"

namespace peerd::replication {

// The bytes that a peer may still send: a token bucket that fills at PublishPolicy::bytes_per_s. Nothing is refused;
// what goes beyond the budget is owed, at most what the rate gives in kOwed_s. A quarter of the rate is reserved for
// updates, whatever the other traffic has taken or owes, or the hellos of many peers would end all updates. Every
// datagram with updates takes all of its bytes from that share, too.
class ByteBudget {
 public:
  // The bytes left for updates, at most what the rate gives in kBurst_s, or one datagram. The policy has a rate.
  [[nodiscard]] double left(const PublishPolicy& policy, SimTime now);
  void spend(std::size_t bytes, bool on_updates);

 private:
  static constexpr double kBurst_s = 0.25, kOwed_s = 2.0, kForUpdates = 0.25;
  std::optional<SimTime> filled_;
  double remaining_ = 0.0, for_updates_ = 0.0;
};

// The updates of one object that no threshold asks for: a token bucket that fills at PublishPolicy::updates_per_s and
// holds PublishPolicy::updates_saved.
class UpdateBudget {
 public:
  // The error [m] beyond which an update is worth one of those that are left: `wanted_error_m` when the bucket is full,
  // twice as much for each that is spent, so that it settles where the object's motion asks for as many as the rate
  // allows. For a given number of updates the mean error is least where the threshold stays the same. None when an
  // update is owed.
  [[nodiscard]] std::optional<double> least_gain_m(const PublishPolicy& policy, SimTime now);
  // Every update takes one. An update that a threshold asks for is not refused; at most one is owed.
  void spend(const PublishPolicy& policy, SimTime now);

 private:
  void fill(const PublishPolicy& policy, SimTime now);
  std::optional<SimTime> filled_;
  double remaining_ = 0.0;
};

}  // namespace peerd::replication
