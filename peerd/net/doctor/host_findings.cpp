#include "peerd/net/doctor/host_findings.hpp"

#include <algorithm>

namespace peerd::doctor {

std::vector<const Link*> links_used(const HostFacts& facts, const Examined& examined) {
  std::vector<const Link*> used;
  for (const Link& link : facts.links) {
    const bool to_a_peer = std::ranges::find(facts.routes, link.name, &Route::interface) != facts.routes.end();
    const bool multicast = examined.transport == Examined::Transport::kMulticast && link.name == examined.interface;
    if (multicast || (examined.transport == Examined::Transport::kUnicast && to_a_peer)) used.push_back(&link);
  }
  return used;
}

std::string names_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<Finding> host_findings(const HostFacts& facts, const Examined& examined) {
  std::vector<Finding> all;
  for (const auto part : {reach_findings, link_findings, limit_findings, place_findings}) {
    std::ranges::move(part(facts, examined), std::back_inserter(all));
  }
  return all;
}

}  // namespace peerd::doctor
