#include "peerd/net/os/interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>

namespace peerd::net {
namespace {

const char* name_of(IpFamily family) { return family == IpFamily::kV4 ? "IPv4" : "IPv6"; }

bool has_address(const Interface& i, IpFamily family) { return family == IpFamily::kV4 ? i.has_ipv4 : i.has_ipv6; }

// Linux routes IPv4 multicast over lo where lo is named as the interface. For IPv6, lo has no multicast route unless an
// administrator adds one.
bool can_multicast(const Interface& i, IpFamily family) {
  return i.up && has_address(i, family) && (i.loopback ? family == IpFamily::kV4 : i.multicast);
}

bool reaches_others(const Interface& i, IpFamily family) {
  return can_multicast(i, family) && !i.loopback && i.running;
}

template <class Predicate>
std::string names_where(const std::vector<Interface>& interfaces, Predicate predicate) {
  std::string names;
  for (const Interface& i : interfaces) {
    if (predicate(i)) names += (names.empty() ? "" : ", ") + i.name;
  }
  return names;
}

std::string advice(const std::vector<Interface>& interfaces, IpFamily family) {
  const std::string names = names_where(interfaces, [&](const Interface& i) { return can_multicast(i, family); });
  const std::string over = std::string(" over ") + name_of(family);
  return names.empty() ? "none here can multicast" + over : "the ones that can multicast" + over + " are: " + names;
}

std::expected<ChosenInterface, NetError> choose_named(const std::vector<Interface>& interfaces, std::string_view wanted,
                                                      IpFamily family) {
  const std::string quoted = "\"" + std::string(wanted) + "\"";
  const auto refuse = [&](NetError::Kind kind, const std::string& problem) {
    return std::unexpected(NetError{kind, problem + "; " + advice(interfaces, family)});
  };
  const auto found = std::ranges::find(interfaces, wanted, &Interface::name);
  if (found == interfaces.end()) {
    return refuse(NetError::Kind::kNoSuchInterface, "no interface named " + quoted + " here");
  }
  if (!found->up) {
    return refuse(NetError::Kind::kNoMulticast,
                  "interface " + quoted + " is down: bring it up (ip link set " + found->name + " up) or name another");
  }
  if (!found->multicast && !found->loopback) {
    return refuse(NetError::Kind::kNoMulticast, "interface " + quoted + " does not do multicast: name another");
  }
  if (!has_address(*found, family)) {
    return refuse(NetError::Kind::kNoMulticast,
                  "interface " + quoted + " has no " + name_of(family) + " address: give it one or name another");
  }
  return ChosenInterface{*found, found->name + ", as configured"};
}

std::expected<ChosenInterface, NetError> choose_by_itself(const std::vector<Interface>& interfaces, IpFamily family) {
  const auto outward = [&](const Interface& i) { return reaches_others(i, family); };
  const auto count = std::ranges::count_if(interfaces, outward);
  if (count == 1) {
    const Interface& only = *std::ranges::find_if(interfaces, outward);
    return ChosenInterface{only, only.name + ", the only one that reaches other computers"};
  }
  const std::string names = names_where(interfaces, outward);
  const auto lo =
      std::ranges::find_if(interfaces, [&](const Interface& i) { return i.loopback && can_multicast(i, family); });
  if (lo != interfaces.end()) {
    return ChosenInterface{*lo, lo->name + (count == 0 ? ", as no other can multicast: this computer only"
                                                       : ", this computer only, as several reach others (" + names +
                                                             ") and none was named")};
  }
  return std::unexpected(NetError{
      NetError::Kind::kNoMulticast,
      count == 0 ? std::string("no interface here can multicast over ") + name_of(family) +
                       "; bring one up with an address, or " +
                       (family == IpFamily::kV6 ? "use an IPv4 group such as 239.192.0.0, which works over lo too"
                                                : "bring up lo (ip link set lo up) to play on this computer alone")
                 : "several interfaces can multicast (" + names + "); name the one to use"});
}

}  // namespace

std::expected<std::vector<Interface>, NetError> list_interfaces() {
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) {
    return std::unexpected(NetError{NetError::Kind::kOther,
                                    "cannot list the network interfaces: " + std::generic_category().message(errno)});
  }
  const std::unique_ptr<ifaddrs, decltype([](ifaddrs* p) { freeifaddrs(p); })> owner(raw);

  std::vector<Interface> interfaces;
  for (const ifaddrs* entry = raw; entry; entry = entry->ifa_next) {  // one entry for each address and for each link
    std::string name = entry->ifa_name;
    name.erase(std::min(name.find(':'), name.size()));  // an address may carry a label such as eth0:1
    auto known = std::ranges::find(interfaces, name, &Interface::name);
    if (known == interfaces.end()) {
      const unsigned index = if_nametoindex(name.c_str());
      if (index == 0) continue;  // the interface has gone in the meantime
      known = interfaces.insert(known, {.name = name,
                                        .index = index,
                                        .up = (entry->ifa_flags & IFF_UP) != 0,
                                        .running = (entry->ifa_flags & IFF_RUNNING) != 0,
                                        .loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0,
                                        .multicast = (entry->ifa_flags & IFF_MULTICAST) != 0});
    }
    if (entry->ifa_addr && entry->ifa_addr->sa_family == AF_INET) known->has_ipv4 = true;
    if (entry->ifa_addr && entry->ifa_addr->sa_family == AF_INET6) known->has_ipv6 = true;
  }
  std::ranges::sort(interfaces, {}, &Interface::index);
  return interfaces;
}

std::expected<ChosenInterface, NetError> choose_interface(const std::vector<Interface>& interfaces,
                                                          std::string_view wanted, IpFamily family) {
  return wanted.empty() ? choose_by_itself(interfaces, family) : choose_named(interfaces, wanted, family);
}

}  // namespace peerd::net
