#include "peerd/net/snapshot/places.hpp"

#include <algorithm>

namespace peerd::snapshot {

std::optional<std::uint64_t> Places::add(std::uint64_t number, const boost::asio::ip::address& from) {
  all_.emplace(number, Connection{.from = from});
  if (all_.size() <= most_) return std::nullopt;
  const std::uint64_t closed = to_close(number);
  all_.erase(closed);
  return closed;
}

std::uint64_t Places::to_close(std::uint64_t added) const {
  const auto unproven = std::ranges::find_if(all_, [](const auto& each) { return !each.second.is_proven; });
  if (unproven != all_.end() && unproven->first != added) return unproven->first;
  std::map<boost::asio::ip::address, std::size_t> counts;
  for (const auto& [number, each] : all_) ++counts[each.from];
  const auto busiest = std::ranges::max_element(counts, {}, [](const auto& each) { return each.second; });
  if (busiest->second < counts[all_.at(added).from] + 2) return added;
  return std::ranges::find_if(all_, [&](const auto& each) { return each.second.from == busiest->first; })->first;
}

void Places::note_proven(std::uint64_t number) {
  const auto found = all_.find(number);
  if (found != all_.end()) found->second.is_proven = true;
}

bool Places::is_proven(std::uint64_t number) const {
  const auto found = all_.find(number);
  return found != all_.end() && found->second.is_proven;
}

}  // namespace peerd::snapshot
