#pragma once
#include "core/time.hpp"

namespace peerd::net {

// So many tokens at once, and so many a second in the long run.
struct TokenRate {
  double most = 0.0;
  double per_second = 0.0;
};

// Limits how often something is done. It has no clock.
class TokenBucket {
 public:
  TokenBucket() = default;  // an empty one
  explicit TokenBucket(const TokenRate& rate, HostTime now = {}) : tokens_(rate.most), counted_(now) {}

  // Takes a token; false: there is none. What has come since the last time came at that rate.
  bool take(const TokenRate& rate, HostTime now);
  [[nodiscard]] double tokens(const TokenRate& rate, HostTime now) const;

 private:
  double tokens_ = 0.0;
  HostTime counted_{};
};

}  // namespace peerd::net
