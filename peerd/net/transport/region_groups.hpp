#pragma once
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/ids.hpp"
#include "peerd/net/os/net_error.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// The mapping of regions to multicast groups, all on one port; every peer of a session has the same plan. Without a
// pool region r has the group base + r. The base 239.192.0.0 (administratively scoped, RFC 2365) leaves room for 2^22
// regions, ff15:: (transient, site-local, RFC 4291) for all 2^32. With a pool, a hash of the region selects one of the
// `pool` groups from the base on: any number of regions share as many groups as routers and network cards support. Each
// datagram then begins with its region (unicast_frame.hpp), and receivers drop datagrams of regions that they have not
// joined.
//
// Two worlds on one network have different groups for their regions, except for one pair of worlds in 256. The base,
// which is the group of the whole scene, is the same for all worlds, so that a peer with another version of a world
// notices it.
struct GroupPlan {
  asio::ip::address base;
  std::uint16_t port = 0;
  std::uint32_t pool = 0;    // groups; 0: one for each region
  std::uint32_t offset = 0;  // of the world: region r > 0 has the group base + offset + r
};

// Makes a plan from a configuration's text; refuses plans that check_plan() refuses.
[[nodiscard]] std::expected<GroupPlan, NetError> parse_group_plan(std::string_view base, std::uint16_t port,
                                                                  std::uint32_t pool = 0);

// The plan of the world with that hash, the same for all its peers. Where few groups follow the base, all worlds have
// the same plan.
[[nodiscard]] GroupPlan plan_of_world(GroupPlan plan, std::uint64_t world_hash);

// Checks that the base is a multicast address, the port is not 0 and the pool stays in the multicast range.
[[nodiscard]] std::expected<void, NetError> check_plan(const GroupPlan& plan);

// The address of the region's datagrams; kLimit where its group would lie beyond the last multicast address.
[[nodiscard]] std::expected<asio::ip::udp::endpoint, NetError> group_endpoint(const GroupPlan& plan, RegionId region);

// The number of the region's group, counted from the base.
[[nodiscard]] std::uint32_t group_number(const GroupPlan& plan, RegionId region);

// The inverse of group_endpoint: the number of a group; none for an address outside of the plan. IPv6 zones are
// ignored.
[[nodiscard]] std::optional<std::uint32_t> group_number(const GroupPlan& plan, const asio::ip::address& group);

// The region whose group has that number; none where regions share groups, or where no region has it.
[[nodiscard]] std::optional<RegionId> region_of_group(const GroupPlan& plan, std::uint32_t number);

}  // namespace peerd::net
