#include "peerd/net/transport/region_groups.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

namespace peerd::net {
namespace {

using asio::ip::address_v4;
using asio::ip::address_v6;

constexpr std::uint64_t kLastIpv4Group = 0xEFFF'FFFF;  // 239.255.255.255
constexpr std::uint64_t kMaxNumber = std::numeric_limits<std::uint32_t>::max();
constexpr RegionId kWhole{0};  // the whole scene
// The distance between the groups of two worlds; few grids have more regions. peerd.lua knows this number.
constexpr std::uint32_t kWorldStep = 1024, kWorldsMost = 256;
// Worlds are spread over at most this fraction of the groups that follow the base, so that a large grid has room after
// the last world.
constexpr std::uint64_t kWorldsShare = 16;

std::optional<address_v4> add(address_v4 base, std::uint32_t number) {
  const std::uint64_t sum = std::uint64_t{base.to_uint()} + number;
  if (sum > kLastIpv4Group) return std::nullopt;
  return address_v4(static_cast<std::uint32_t>(sum));
}

// An IPv6 address as two numbers in host order.
struct Halves {
  std::uint64_t high = 0, low = 0;
};

Halves halves_of(const address_v6& address) {
  const auto bytes = address.to_bytes();
  Halves h;
  for (std::size_t i = 0; i < 8; ++i) {
    h.high = h.high << 8 | bytes[i];
    h.low = h.low << 8 | bytes[i + 8];
  }
  return h;
}

address_v6 address_of(Halves h) {
  address_v6::bytes_type bytes{};
  for (std::size_t i = 8; i-- > 0; h.high >>= 8, h.low >>= 8) {
    bytes[i] = static_cast<unsigned char>(h.high);
    bytes[i + 8] = static_cast<unsigned char>(h.low);
  }
  return address_v6(bytes);
}

// The top 16 bits (ff, flags, scope) are not part of the group's number, for a carry into them would change the scope.
std::optional<address_v6> add(const address_v6& base, std::uint32_t number) {
  const Halves from = halves_of(base);
  Halves to{from.high, from.low + number};
  if (to.low < from.low) ++to.high;
  if (to.high >> 48 != from.high >> 48) return std::nullopt;
  return address_of(to);
}

std::optional<asio::ip::address> nth_group(const asio::ip::address& base, std::uint32_t number) {
  if (base.is_v4()) return add(base.to_v4(), number);
  return add(base.to_v6(), number);
}

// The finaliser of MurmurHash3 (A. Appleby, public domain): each bit of the region changes half of the result's bits.
// With the remainder alone, a grid with rows as long as the pool would put whole columns into one group.
std::uint32_t hash(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x85EB'CA6Bu;
  x = (x ^ x >> 13) * 0xC2B2'AE35u;
  return x ^ x >> 16;
}

}  // namespace

std::expected<GroupPlan, NetError> parse_group_plan(std::string_view base, std::uint16_t port, std::uint32_t pool) {
  boost::system::error_code ec;
  GroupPlan plan{asio::ip::make_address(std::string(base), ec), port, pool};
  if (ec) {
    return std::unexpected(NetError{NetError::Kind::kBadSetting,
                                    "\"" + std::string(base) +
                                        "\" is not an IP address; give the first multicast group, such as 239.192.0.0 "
                                        "or ff15::1:0:0"});
  }
  if (auto good = check_plan(plan); !good) return std::unexpected(good.error());
  return plan;
}

std::expected<void, NetError> check_plan(const GroupPlan& plan) {
  if (!plan.base.is_multicast()) {
    return std::unexpected(NetError{NetError::Kind::kBadSetting,
                                    plan.base.to_string() +
                                        " is not a multicast address; take one from 239.192.0.0 to 239.195.255.255, "
                                        "or an IPv6 one such as ff15::1:0:0"});
  }
  if (plan.port == 0) {
    return std::unexpected(NetError{NetError::Kind::kBadSetting,
                                    "port 0 would give every peer a port of its own; choose one from 1024 to 65535"});
  }
  if (plan.pool > 0 && !nth_group(plan.base, plan.pool - 1)) {
    return std::unexpected(NetError{NetError::Kind::kBadSetting,
                                    "a pool of " + std::to_string(plan.pool) + " groups from " + plan.base.to_string() +
                                        " on leaves the multicast range; lower the base address or the pool"});
  }
  return {};
}

std::expected<asio::ip::udp::endpoint, NetError> group_endpoint(const GroupPlan& plan, RegionId region) {
  assert(check_plan(plan));
  const auto group = nth_group(plan.base, group_number(plan, region));
  if (!group) {
    return std::unexpected(
        NetError{NetError::Kind::kLimit, "region " + std::to_string(region.value) +
                                             " has no multicast group: " + plan.base.to_string() +
                                             " + region leaves the multicast range; lower the base address or let "
                                             "regions share groups (transport.group_pool)"});
  }
  return asio::ip::udp::endpoint(*group, plan.port);
}

GroupPlan plan_of_world(GroupPlan plan, std::uint64_t world_hash) {
  const std::uint64_t room = plan.base.is_v4() ? kLastIpv4Group - plan.base.to_v4().to_uint() : kMaxNumber;
  const std::uint64_t worlds = std::min<std::uint64_t>(kWorldsMost, room / kWorldsShare / kWorldStep);
  plan.offset = worlds > 0 ? kWorldStep * static_cast<std::uint32_t>(world_hash % worlds) : 0;
  return plan;
}

std::uint32_t group_number(const GroupPlan& plan, RegionId region) {
  if (region == kWhole) return 0;
  return plan.pool == 0 ? plan.offset + region.value : hash(plan.offset + region.value) % plan.pool;
}

std::optional<RegionId> region_of_group(const GroupPlan& plan, std::uint32_t number) {
  if (plan.pool > 0 || (number > 0 && number <= plan.offset)) return std::nullopt;
  return number == 0 ? kWhole : RegionId{number - plan.offset};
}

namespace {

std::optional<std::uint32_t> distance(const GroupPlan& plan, const asio::ip::address& group) {
  if (plan.base.is_v4() != group.is_v4() || !group.is_multicast()) return std::nullopt;
  if (group.is_v4()) {
    const std::uint32_t base = plan.base.to_v4().to_uint(), number = group.to_v4().to_uint();
    return number < base ? std::nullopt : std::optional(number - base);
  }
  const Halves base = halves_of(plan.base.to_v6()), number = halves_of(group.to_v6());
  const std::uint64_t low = number.low - base.low;
  const std::uint64_t high = number.high - base.high - (number.low < base.low ? 1 : 0);
  // Groups may lie beyond a carry from the low to the high half, but not beyond one into the scope, which
  // group_endpoint() refuses.
  if (high != 0 || low > kMaxNumber || number.high >> 48 != base.high >> 48) return std::nullopt;
  return static_cast<std::uint32_t>(low);
}

}  // namespace

std::optional<std::uint32_t> group_number(const GroupPlan& plan, const asio::ip::address& group) {
  const auto number = distance(plan, group);
  return number && plan.pool > 0 && *number >= plan.pool ? std::nullopt : number;
}

}  // namespace peerd::net
