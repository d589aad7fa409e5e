#include "peerd/net/doctor/host_facts.hpp"

#include <linux/if_bridge.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "peerd/net/doctor/netlink.hpp"
#include "peerd/net/os/udp_socket.hpp"

namespace peerd::doctor {
namespace {

// The timers of other queriers run while these are heard (since Linux 5.16; before, none is known).
bool hears_another_querier(std::span<const std::byte> state) {
  bool hears = false;
  for_each_attribute(state, [&](const Attribute& a) {
    if (a.type == BRIDGE_QUERIER_IP_OTHER_TIMER || a.type == BRIDGE_QUERIER_IPV6_OTHER_TIMER) hears = true;
  });
  return hears;
}

void read_bridge(Link& link, std::span<const std::byte> data) {
  for_each_attribute(data, [&](const Attribute& a) {
    if (a.type == IFLA_BR_MCAST_SNOOPING) link.snooping = a.number<std::uint8_t>() != 0;
    if (a.type == IFLA_BR_MCAST_QUERIER) link.querier = a.number<std::uint8_t>() != 0;
    if (a.type == IFLA_BR_MCAST_QUERIER_STATE) link.querier_elsewhere = hears_another_querier(a.value);
  });
}

void read_kind(Link& link, std::span<const std::byte> info) {
  std::span<const std::byte> data;
  for_each_attribute(info, [&](const Attribute& a) {
    if (a.type == IFLA_INFO_KIND) link.kind = a.text();
    if (a.type == IFLA_INFO_DATA) data = a.value;
  });
  if (link.kind == "bridge") read_bridge(link, data);
}

Link link_of(std::span<const std::byte> message) {
  ifinfomsg header;
  std::memcpy(&header, message.data(), sizeof header);
  Link link{.name = "", .index = static_cast<unsigned>(header.ifi_index)};
  link.up = (header.ifi_flags & IFF_UP) != 0;
  link.has_carrier = (header.ifi_flags & IFF_RUNNING) != 0;
  link.loopback = (header.ifi_flags & IFF_LOOPBACK) != 0;
  link.multicast = (header.ifi_flags & IFF_MULTICAST) != 0;
  for_each_attribute(message.subspan(NLMSG_ALIGN(sizeof header)), [&](const Attribute& a) {
    if (a.type == IFLA_IFNAME) link.name = a.text();
    if (a.type == IFLA_MTU) link.mtu_bytes = a.number<std::uint32_t>();
    if (a.type == IFLA_MASTER) link.bridge_index = a.number<std::uint32_t>();
    if (a.type == IFLA_LINK_NETNSID) link.other_end_elsewhere = true;
    // The flag follows a lost carrier up to a second later.
    if (a.type == IFLA_CARRIER && a.number<std::uint8_t>() == 0) link.has_carrier = false;
    if (a.type == IFLA_LINKINFO) read_kind(link, a.value);
  });
  return link;
}

// SIOCGIWNAME of linux/wireless.h, which cannot be included beside net/if.h. Only wireless interfaces have a name of
// their protocol; its request is shorter than an ifreq.
constexpr unsigned long kAskWirelessName = 0x8B01;

bool is_wireless(const std::string& name) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  ifreq asked{};
  name.copy(asked.ifr_name, IFNAMSIZ - 1);
  const bool answered = ioctl(fd, kAskWirelessName, &asked) == 0;
  close(fd);
  return answered;
}

}  // namespace

std::expected<std::vector<Link>, net::NetError> read_links() {
  const ifinfomsg all{};
  std::vector<Link> links;
  const auto read = dump(NETLINK_ROUTE, RTM_GETLINK, std::as_bytes(std::span(&all, 1)),
                         [&](std::uint16_t type, std::span<const std::byte> message) {
                           if (type == RTM_NEWLINK && message.size() >= sizeof all) links.push_back(link_of(message));
                         });
  if (!read) {
    return net::failure(net::NetError::Kind::kOther,
                        "cannot list the network interfaces: " + net::text_of(read.error()));
  }
  for (Link& link : links) link.wireless = is_wireless(link.name);
  return links;
}

}  // namespace peerd::doctor
