#pragma once
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/ids.hpp"
#include "peerd/os/net_error.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// Which multicast group carries which region, all on one port; every peer of a session has the same plan. Without a
// pool region r has the group base + r. 239.192.0.0 (administratively scoped, RFC 2365) leaves room for 2^22 regions;
// ff15:: (transient, site-local, RFC 4291) for all 2^32. With a pool, a hash of the region picks one of the `pool`
// groups from the base on: any number of regions in as many groups as routers and network cards bear. Regions then
// share groups, so that each datagram says its own (unicast_frame.hpp), and who joins some hears others, and drops
// them.
//
// Two worlds on one network have different groups for their regions, but for one pair in 256. The whole scene's
// group, the base, is everybody's: who runs another version of a world must hear that it does.
struct GroupPlan {
  asio::ip::address base;
  std::uint16_t port = 0;
  std::uint32_t pool = 0;    // groups; 0: one for each region
  std::uint32_t offset = 0;  // of a world: region r > 0 has the group base + offset + r
};

// A plan from a configuration's text; refuses what check_plan refuses.
[[nodiscard]] std::expected<GroupPlan, NetError> parse_group_plan(std::string_view base, std::uint16_t port,
                                                                  std::uint32_t pool = 0);

// The plan of a world, whose hash it is: the same on all its peers. Where few groups follow the base, that of all.
[[nodiscard]] GroupPlan plan_of_world(GroupPlan plan, std::uint64_t world_hash);

// The base must be a multicast address and the port must not be 0.
[[nodiscard]] std::expected<void, NetError> check_plan(const GroupPlan& plan);

// Where datagrams of that region are sent; kLimit when its group would lie beyond the last multicast address.
[[nodiscard]] std::expected<asio::ip::udp::endpoint, NetError> group_endpoint(const GroupPlan& plan, RegionId region);

// The number of that region's group, counted from the base.
[[nodiscard]] std::uint32_t group_number(const GroupPlan& plan, RegionId region);

// The inverse of group_endpoint: the number of a group; none for an address outside of the plan. IPv6 zones are
// ignored.
[[nodiscard]] std::optional<std::uint32_t> group_number(const GroupPlan& plan, const asio::ip::address& group);

// The region whose group has that number; none where regions share groups, or where it is of none.
[[nodiscard]] std::optional<RegionId> region_of_group(const GroupPlan& plan, std::uint32_t number);

}  // namespace peerd::net
