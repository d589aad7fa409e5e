#include "peerd/transport/token_bucket.hpp"

#include <algorithm>

namespace peerd::net {

bool TokenBucket::take(const TokenRate& rate, HostTime now) {
  const double since_s = std::max(0.0, to_seconds(now - counted_));
  tokens_ = std::min(rate.most, tokens_ + since_s * rate.per_second);
  counted_ = now;
  if (tokens_ < 1.0) return false;
  tokens_ -= 1.0;
  return true;
}

}  // namespace peerd::net
