#include "replication/settings/policy/budget.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "replication/wire/codec.hpp"

namespace peerd::replication {

double ByteBudget::left(const PublishPolicy& policy, SimTime now) {
  assert(policy.bytes_per_s && *policy.bytes_per_s > 0.0);
  const double most = std::max(kBurst_s * *policy.bytes_per_s, static_cast<double>(kDatagramMax_bytes));
  const double owed_most = kOwed_s * *policy.bytes_per_s;
  remaining_ = filled_ ? std::max(remaining_, -owed_most) : most;
  for_updates_ = std::max(for_updates_, -owed_most);
  if (filled_ && now > *filled_) {
    const double more = *policy.bytes_per_s * to_seconds(now - *filled_);
    remaining_ = std::min(most, remaining_ + more);
    for_updates_ = std::min(static_cast<double>(kDatagramMax_bytes), for_updates_ + kForUpdates * more);
  }
  filled_ = now;
  return for_updates_ > std::max(remaining_, 0.0) ? for_updates_ : remaining_;
}

void ByteBudget::spend(std::size_t bytes, bool on_updates) {
  remaining_ -= static_cast<double>(bytes);
  if (on_updates) for_updates_ -= static_cast<double>(bytes);
}

void UpdateBudget::fill(const PublishPolicy& policy, SimTime now) {
  assert(policy.updates_saved >= 1.0 && policy.updates_per_s >= 0.0);
  if (!filled_) remaining_ = policy.updates_saved;
  if (filled_ && now > *filled_) {
    remaining_ = std::min(policy.updates_saved, remaining_ + policy.updates_per_s * to_seconds(now - *filled_));
  }
  filled_ = now;
}

std::optional<double> UpdateBudget::least_gain_m(const PublishPolicy& policy, SimTime now) {
  fill(policy, now);
  if (remaining_ < 0.0) return std::nullopt;
  return policy.wanted_error_m * std::exp2(policy.updates_saved - remaining_);
}

void UpdateBudget::spend(const PublishPolicy& policy, SimTime now) {
  fill(policy, now);
  remaining_ = std::max(-1.0, remaining_ - 1.0);
  assert(remaining_ >= -1.0 && remaining_ <= policy.updates_saved);
}

}  // namespace peerd::replication
