#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "core/ids.hpp"

namespace peerd::relay {

inline constexpr RegionId kWholeScene{0};

using LinkId = std::uint32_t;

// The regions that somebody wants.
struct Wanted {
  bool all = false;
  std::vector<RegionId> regions = {};  // ascending; empty where `all` is set
  friend bool operator==(const Wanted&, const Wanted&) = default;
};

// The links of a relay, and the regions that somebody behind each of them wants. Sans-IO.
class ForwardingTable {
 public:
  // False: it was so before.
  bool set(LinkId link, Wanted wanted);
  bool remove(LinkId link) { return set(link, {}); }

  // Calls visit(LinkId) for each link where the region is wanted, each once.
  template <class Visit>
  void visit(RegionId region, Visit visit) const {
    for (const LinkId link : all_) visit(link);
    const auto named = by_region_.find(region.value);
    if (named == by_region_.end()) return;
    for (const LinkId link : named->second) visit(link);
  }

  // The regions that are wanted behind the other links: what is to be received over this one.
  [[nodiscard]] Wanted wanted_by_others(LinkId link) const;
  [[nodiscard]] std::size_t regions() const { return by_region_.size(); }  // named by a link

 private:
  void erase(LinkId link, const Wanted& wanted);

  std::map<LinkId, Wanted> wanted_;  // of the links that want something
  std::unordered_map<std::uint32_t, std::vector<LinkId>> by_region_;
  std::vector<LinkId> all_;  // that want all regions
};

}  // namespace peerd::relay
