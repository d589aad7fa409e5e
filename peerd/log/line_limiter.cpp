#include "peerd/log/line_limiter.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>

namespace peerd {
namespace {

constexpr const char* kOtherKinds = "(lines of other kinds)";

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::string kind_of_line(std::string_view text) {
  std::string kind;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_digit(text[i])) {
      kind += text[i];
      continue;
    }
    kind += '#';
    // A point or a comma between two digits is part of the number.
    const auto goes_on = [&](std::size_t at) {
      return at < text.size() && (is_digit(text[at]) || ((text[at] == '.' || text[at] == ',') && at + 1 < text.size() &&
                                                         is_digit(text[at + 1])));
    };
    while (goes_on(i + 1)) ++i;
  }
  return kind;
}

double LineLimiter::tokens_at(const Bucket& bucket, HostTime now) const {
  const double gained = to_seconds(now - bucket.filled) * limits_.per_second;
  return std::min<double>(limits_.burst, bucket.tokens + gained);
}

LineLimiter::Bucket& LineLimiter::bucket_of(HostTime now, std::string_view text) {
  const std::string kind = kind_of_line(text);
  const auto known = buckets_.find(kind);
  if (known != buckets_.end()) return known->second;
  if (buckets_.size() >= kKindsMax) {  // a kind whose bucket is full again is as one that never came
    std::erase_if(buckets_, [&](const auto& entry) {
      return entry.second.left_out == 0 && tokens_at(entry.second, now) >= limits_.burst;
    });
  }
  const std::string& name = buckets_.size() >= kKindsMax ? kOtherKinds : kind;
  return buckets_.try_emplace(name, Bucket{.tokens = static_cast<double>(limits_.burst), .filled = now}).first->second;
}

bool LineLimiter::admits(HostTime now, std::string_view text) {
  Bucket& bucket = bucket_of(now, text);
  assert(now >= bucket.filled);
  bucket.tokens = tokens_at(bucket, now);
  bucket.filled = now;
  if (bucket.tokens >= 1.0) {
    bucket.tokens -= 1.0;
    return true;
  }
  if (bucket.left_out == 0) bucket.since = now;
  ++bucket.left_out;
  return false;
}

std::vector<LineLimiter::LeftOut> LineLimiter::take_left_out(HostTime now) {
  std::vector<LeftOut> taken;
  for (auto& [kind, bucket] : buckets_) {
    if (bucket.left_out == 0 || now - bucket.since < kReportAfter) continue;
    taken.push_back({kind, bucket.left_out});
    bucket.left_out = 0;
  }
  return taken;
}

std::vector<LineLimiter::LeftOut> LineLimiter::take_all_left_out() { return take_left_out(HostTime::max()); }

}  // namespace peerd
