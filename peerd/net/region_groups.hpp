#pragma once
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/ids.hpp"
#include "peerd/net/net_error.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// Which multicast group carries which region: region r -> base + r, all on one port. Every peer of a session has the
// same plan. 239.192.0.0 (administratively scoped, RFC 2365) leaves room for 2^22 regions; ff15:: (transient,
// site-local, RFC 4291) for all 2^32.
struct GroupPlan {
  asio::ip::address base;
  std::uint16_t port = 0;
};

// A plan from a configuration's text; refuses what check_plan refuses.
[[nodiscard]] std::expected<GroupPlan, NetError> parse_group_plan(std::string_view base, std::uint16_t port);

// The base must be a multicast address and the port must not be 0.
[[nodiscard]] std::expected<void, NetError> check_plan(const GroupPlan& plan);

// Where datagrams of that region are sent; kLimit when the region lies beyond the last group that follows the base.
[[nodiscard]] std::expected<asio::ip::udp::endpoint, NetError> group_endpoint(const GroupPlan& plan, RegionId region);

// The inverse: the region that a group carries; none for an address outside of the plan. IPv6 zones are ignored.
[[nodiscard]] std::optional<RegionId> region_of(const GroupPlan& plan, const asio::ip::address& group);

}  // namespace peerd::net
