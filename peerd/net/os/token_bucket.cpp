#include "peerd/net/os/token_bucket.hpp"

#include <algorithm>

namespace peerd::net {

double TokenBucket::tokens(const TokenRate& rate, HostTime now) const {
  const double since_s = std::max(0.0, to_seconds(now - counted_));
  return std::min(rate.most, tokens_ + since_s * rate.per_second);
}

bool TokenBucket::take(const TokenRate& rate, HostTime now) {
  tokens_ = tokens(rate, now);
  counted_ = now;
  if (tokens_ < 1.0) return false;
  tokens_ -= 1.0;
  return true;
}

}  // namespace peerd::net
