#include "peerd/daemon/log/line_limiter.hpp"

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

LineLimiter::Kind& LineLimiter::kind_of(HostTime now, std::string_view text) {
  const std::string name = kind_of_line(text);
  const auto known = kinds_.find(name);
  if (known != kinds_.end()) return known->second;
  if (kinds_.size() >= kKindsMax) {  // a kind whose bucket is full again is as one that never came
    std::erase_if(kinds_, [&](const auto& entry) {
      return entry.second.left_out == 0 && entry.second.bucket.tokens(limits_, now) >= limits_.most;
    });
  }
  const std::string counts_as = kinds_.size() >= kKindsMax ? kOtherKinds : name;
  return kinds_.try_emplace(counts_as, Kind{.bucket = net::TokenBucket(limits_, now)}).first->second;
}

bool LineLimiter::admits(HostTime now, std::string_view text) {
  Kind& kind = kind_of(now, text);
  if (kind.bucket.take(limits_, now)) return true;
  if (kind.left_out == 0) kind.since = now;
  ++kind.left_out;
  return false;
}

std::vector<LineLimiter::LeftOut> LineLimiter::take_left_out(HostTime now) {
  std::vector<LeftOut> taken;
  for (auto& [name, kind] : kinds_) {
    if (kind.left_out == 0 || now - kind.since < kReportAfter) continue;
    taken.push_back({name, kind.left_out});
    kind.left_out = 0;
  }
  return taken;
}

std::vector<LineLimiter::LeftOut> LineLimiter::take_all_left_out() { return take_left_out(HostTime::max()); }

}  // namespace peerd
