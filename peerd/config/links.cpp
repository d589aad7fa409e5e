#include "peerd/config/links.hpp"

namespace peerd::config {

const LinkSettings& link(const RunSettings& run, const std::string& from, const std::string& to) {
  if (const auto at = run.links.find({from, to}); at != run.links.end()) return at->second;
  const auto of_sender = run.island_of.find(from), of_receiver = run.island_of.find(to);
  const bool is_within = of_sender != run.island_of.end() && of_receiver != run.island_of.end() &&
                         of_sender->second == of_receiver->second;
  return is_within ? run.islands[of_sender->second].within : run.network;
}

std::vector<LinkSettings> links_of(const RunSettings& run) {
  std::vector<LinkSettings> links{run.network};
  for (const IslandSettings& island : run.islands) links.push_back(island.within);
  for (const auto& [ends, link] : run.links) links.push_back(link);
  return links;
}

}  // namespace peerd::config
