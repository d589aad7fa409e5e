#include "peerd/net/os/interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <system_error>

namespace peerd::net {
namespace {

namespace asio = boost::asio;

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

std::optional<asio::ip::address> address_of(const sockaddr* at) {
  if (at == nullptr) return std::nullopt;
  if (at->sa_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, at, sizeof(v4));
    return asio::ip::address_v4(ntohl(v4.sin_addr.s_addr));
  }
  if (at->sa_family != AF_INET6) return std::nullopt;
  sockaddr_in6 v6{};
  std::memcpy(&v6, at, sizeof(v6));
  asio::ip::address_v6::bytes_type bytes{};
  std::memcpy(bytes.data(), &v6.sin6_addr, bytes.size());
  return asio::ip::address_v6(bytes);
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

constexpr const char* kSayIpv6 = "say --ipv6, or an IPv6 group (--group ff15::50:0)";

// The advice to take IPv6 where IPv4 is wanted and not to be had; else empty.
std::string ipv6_instead(const std::vector<Interface>& interfaces, IpFamily family) {
  if (family == IpFamily::kV6) return "";
  const auto by_ipv6 = [](const Interface& i) { return reaches_others(i, IpFamily::kV6); };
  const std::string names = names_where(interfaces, by_ipv6);
  return names.empty() ? "" : names + " can over IPv6: " + kSayIpv6;
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
  if (!has_address(*found, family) && family == IpFamily::kV4 && can_multicast(*found, IpFamily::kV6)) {
    return refuse(NetError::Kind::kNoMulticast,
                  "interface " + quoted + " has no IPv4 address, and has an IPv6 one: " + kSayIpv6);
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
    const std::string instead = count == 0 ? ipv6_instead(interfaces, family) : "";
    if (!instead.empty()) {
      return ChosenInterface{*lo, lo->name + ", as no other can multicast over IPv4: this computer only; " + instead};
    }
    return ChosenInterface{*lo, lo->name + (count == 0 ? ", as no other can multicast: this computer only"
                                                       : ", this computer only, as several reach others (" + names +
                                                             ") and none was named")};
  }
  if (const std::string instead = count == 0 ? ipv6_instead(interfaces, family) : ""; !instead.empty()) {
    return std::unexpected(
        NetError{NetError::Kind::kNoMulticast, "no interface here can multicast over IPv4; " + instead});
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
    const auto address = address_of(entry->ifa_addr);
    if (address && address->is_v6() && !address->to_v6().is_link_local()) known->has_wide_ipv6 = true;
  }
  std::ranges::sort(interfaces, {}, &Interface::index);
  return interfaces;
}

// As if_nametoindex(), which says that there is no such file where no descriptor is left.
std::expected<unsigned, int> index_of(const std::string& name) {
  ifreq request{};
  if (name.size() >= sizeof(request.ifr_name)) return 0U;
  std::ranges::copy(name, std::begin(request.ifr_name));
  const int any = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (any < 0) return std::unexpected(errno);
  const int error = ioctl(any, SIOCGIFINDEX, &request) == 0 ? 0 : errno;
  close(any);
  if (error == 0) return static_cast<unsigned>(request.ifr_ifindex);
  if (error == ENODEV || error == ENXIO) return 0U;
  return std::unexpected(error);
}

bool are_of_one_interface(const asio::ip::address& a, const asio::ip::address& b) {
  // An IPv6 address of link-local scope may come with its interface or without.
  const auto plain = [](const asio::ip::address& each) {
    return each.is_v6() ? asio::ip::address(asio::ip::address_v6(each.to_v6().to_bytes())) : each;
  };
  if (plain(a) == plain(b)) return true;
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) return false;
  const std::unique_ptr<ifaddrs, decltype([](ifaddrs* p) { freeifaddrs(p); })> owner(raw);
  std::set<std::string> of_a, of_b;
  for (const ifaddrs* entry = raw; entry; entry = entry->ifa_next) {
    const auto address = address_of(entry->ifa_addr);
    if (!address) continue;
    std::string name = entry->ifa_name;
    name.erase(std::min(name.find(':'), name.size()));
    if (*address == plain(a)) of_a.insert(name);
    if (*address == plain(b)) of_b.insert(name);
  }
  return std::ranges::any_of(of_a, [&](const std::string& name) { return of_b.contains(name); });
}

bool has_ipv6_alone(const std::vector<Interface>& interfaces, std::string_view wanted) {
  const auto counts = [&](const Interface& i) { return wanted.empty() ? !i.loopback && i.running : i.name == wanted; };
  const auto by_ipv4 = [&](const Interface& i) { return counts(i) && can_multicast(i, IpFamily::kV4); };
  const auto by_ipv6 = [&](const Interface& i) {
    return counts(i) && i.has_wide_ipv6 && can_multicast(i, IpFamily::kV6);
  };
  return std::ranges::none_of(interfaces, by_ipv4) && std::ranges::any_of(interfaces, by_ipv6);
}

std::expected<ChosenInterface, NetError> choose_interface(const std::vector<Interface>& interfaces,
                                                          std::string_view wanted, IpFamily family) {
  return wanted.empty() ? choose_by_itself(interfaces, family) : choose_named(interfaces, wanted, family);
}

}  // namespace peerd::net
