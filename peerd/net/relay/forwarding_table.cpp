#include "peerd/net/relay/forwarding_table.hpp"

#include <cassert>
#include <utility>

namespace peerd::relay {

bool ForwardingTable::set(LinkId link, Wanted wanted) {
  assert(!wanted.all || wanted.regions.empty());
  const auto before = wanted_.find(link);
  if (before == wanted_.end() ? wanted == Wanted{} : wanted == before->second) return false;
  if (before != wanted_.end()) {
    erase(link, before->second);
    wanted_.erase(before);
  }
  if (wanted == Wanted{}) return true;
  if (wanted.all) all_.push_back(link);
  for (const RegionId region : wanted.regions) by_region_[region.value].push_back(link);
  wanted_.emplace(link, std::move(wanted));
  return true;
}

void ForwardingTable::erase(LinkId link, const Wanted& wanted) {
  if (wanted.all) std::erase(all_, link);
  for (const RegionId region : wanted.regions) {
    const auto named = by_region_.find(region.value);
    assert(named != by_region_.end());
    std::erase(named->second, link);
    if (named->second.empty()) by_region_.erase(named);
  }
}

Wanted ForwardingTable::wanted_by_others(LinkId link) const {
  const auto is_other = [link](LinkId each) { return each != link; };
  if (std::ranges::any_of(all_, is_other)) return {.all = true};
  Wanted wanted;
  for (const auto& [region, links] : by_region_) {
    if (std::ranges::any_of(links, is_other)) wanted.regions.push_back(RegionId{region});
  }
  std::ranges::sort(wanted.regions);
  return wanted;
}

}  // namespace peerd::relay
