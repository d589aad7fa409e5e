#include "peerd/net/seal/first_heard.hpp"

namespace peerd::seal {

void FirstHeard::note(const BootId& boot, HostTime now) {
  if (first_.size() >= kMost && !first_.contains(boot)) first_.clear();
  first_.try_emplace(boot, now);
}

bool FirstHeard::is_old(const BootId& boot, HostTime now) const {
  const auto first = first_.find(boot);
  return first != first_.end() && first->second + kNew < now;
}

}  // namespace peerd::seal
