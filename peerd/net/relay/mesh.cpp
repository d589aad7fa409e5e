#include "peerd/net/relay/mesh.hpp"

#include <utility>

namespace peerd::relay {

std::expected<std::unique_ptr<Mesh>, net::NetError> Mesh::open(boost::asio::io_context& io, const net::HostClock& clock,
                                                               const net::UnicastOptions& options) {
  auto fan_out = net::UnicastFanOut::open(io, clock, options);
  if (!fan_out) return std::unexpected(fan_out.error());
  return std::unique_ptr<Mesh>(new Mesh(*std::move(fan_out)));
}

void Mesh::start(OnDatagram on_datagram, OnChange on_change) {
  on_change_ = std::move(on_change);
  fan_out_->on_receive([passed = std::move(on_datagram)](const net::Arrival& arrival) {
    passed(arrival.region, arrival.datagram, arrival.at);
  });
}

std::optional<std::string> Mesh::advance(HostTime, const Place&) {
  Wanted now = wanted();
  if (now != before_) on_change_();
  before_ = std::move(now);
  auto change = fan_out_->follow_interface();
  return change ? std::optional(std::move(change->sentence)) : std::nullopt;
}

Wanted Mesh::wanted() const {
  Wanted wanted;
  std::set<RegionId> regions;
  for (const net::KnownPeers::Peer& peer : fan_out_->peers()) {
    wanted.all = wanted.all || peer.all_regions;
    regions.insert(peer.regions.begin(), peer.regions.end());
  }
  if (!wanted.all) wanted.regions.assign(regions.begin(), regions.end());
  return wanted;
}

// Nobody can name all regions that there are: where somebody wants all of them, those of the mesh's own peers are among
// them.
void Mesh::receive(const Wanted& wanted_elsewhere) {
  std::set<RegionId> regions(wanted_elsewhere.regions.begin(), wanted_elsewhere.regions.end());
  if (wanted_elsewhere.all) {
    const Wanted here = wanted();
    regions.insert(here.regions.begin(), here.regions.end());
  }
  for (const RegionId region : joined_) {
    if (!regions.contains(region)) (void)fan_out_->leave(region);  // by unicast neither can fail
  }
  for (const RegionId region : regions) (void)fan_out_->join(region);
  joined_ = std::move(regions);
}

}  // namespace peerd::relay
