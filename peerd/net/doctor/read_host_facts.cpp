#include "peerd/net/doctor/host_facts.hpp"

#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "peerd/net/os/os_clock.hpp"
#include "peerd/net/os/udp_socket.hpp"

namespace peerd::doctor {
namespace {

using boost::asio::ip::address;
using boost::asio::ip::tcp;
using boost::asio::ip::udp;

std::optional<std::size_t> number_in(const char* file) {
  std::size_t number = 0;
  if (!(std::ifstream(file) >> number)) return std::nullopt;
  return number;
}

// The greater one of the interface's setting and that of all counts (Documentation/networking/ip-sysctl.rst).
bool drops_by_source(const std::string& interface) {
  const std::string settings = "/proc/sys/net/ipv4/conf/";
  const auto own = number_in((settings + interface + "/rp_filter").c_str());
  const auto all = number_in((settings + "all/rp_filter").c_str());
  return std::max(own.value_or(0), all.value_or(0)) == 1;
}

// A counter of /proc/net/netstat, which has a line of names and one of numbers for each group.
std::size_t counter_of(const std::string& group, const std::string& name) {
  std::ifstream file("/proc/thread-self/net/netstat");
  std::string names, numbers;
  while (std::getline(file, names) && std::getline(file, numbers)) {
    std::istringstream of_names(names), of_numbers(numbers);
    std::string each_name, each_number;
    if (!(of_names >> each_name) || each_name != group) continue;
    of_numbers >> each_number;  // the group again
    std::size_t number = 0;
    while (of_names >> each_name && of_numbers >> number) {
      if (each_name == name) return number;
    }
  }
  return 0;
}

// The files that container managers leave for programs inside. Where the kernel's own threads are among the processes,
// the root file system may have been a container's image, but this is none, or one that shares its host's processes.
std::string container_here() {
  std::string thread, manager;
  if (std::ifstream("/proc/2/comm") >> thread && thread == "kthreadd") return "";
  if (std::ifstream("/run/systemd/container") >> manager) return manager;
  std::error_code ignored;
  if (std::filesystem::exists("/run/.containerenv", ignored)) return "podman";
  if (std::filesystem::exists("/.dockerenv", ignored)) return "docker";
  return "";
}

address address_of(const sockaddr& any) {
  if (any.sa_family == AF_INET)
    return boost::asio::ip::address_v4(ntohl(reinterpret_cast<const sockaddr_in&>(any).sin_addr.s_addr));
  if (any.sa_family != AF_INET6) return {};
  boost::asio::ip::address_v6::bytes_type bytes;
  std::memcpy(bytes.data(), &reinterpret_cast<const sockaddr_in6&>(any).sin6_addr, bytes.size());
  return boost::asio::ip::address_v6(bytes);
}

// The interface that has the address; empty: none, or the interfaces can't be listed.
std::string interface_with(address wanted) {
  if (wanted.is_v6()) wanted = boost::asio::ip::address_v6(wanted.to_v6().to_bytes());  // without its zone
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) return "";
  const std::unique_ptr<ifaddrs, decltype([](ifaddrs* p) { freeifaddrs(p); })> owner(raw);
  for (const ifaddrs* entry = raw; entry; entry = entry->ifa_next) {
    if (entry->ifa_addr && address_of(*entry->ifa_addr) == wanted) return entry->ifa_name;
  }
  return "";
}

}  // namespace

// Connecting a UDP socket sends nothing: the kernel chooses the route and the source address.
Route route_to(const NamedPeer& peer) {
  boost::asio::io_context io(1);
  udp::socket socket(io);
  boost::system::error_code ec;
  socket.connect(peer.address, ec);
  if (ec) return {peer.text, Route::Way::kNone};
  const address from = socket.local_endpoint(ec).address();
  if (ec) return {peer.text, Route::Way::kNone};
  if (from.is_loopback() || from == peer.address.address()) return {peer.text, Route::Way::kThisComputer};
  return {peer.text, Route::Way::kOutwards, interface_with(from)};
}

// Peers share the port for questions, and a port that TCP has just left can be used again: both need SO_REUSEADDR.
OtherPorts taken_of(const OtherPorts& ports) {
  boost::asio::io_context io(1);
  const auto is_taken = [](auto& socket, std::uint16_t port) {
    boost::system::error_code ec;
    socket.set_option(boost::asio::socket_base::reuse_address(true), ec);
    if (!ec) socket.bind({boost::asio::ip::address_v4::any(), port}, ec);
    return ec == boost::asio::error::address_in_use;
  };
  OtherPorts taken;
  udp::socket questions(io, udp::v4());
  tcp::acceptor joins(io, tcp::v4());
  if (ports.discovery != 0 && is_taken(questions, ports.discovery)) taken.discovery = ports.discovery;
  if (ports.snapshot != 0 && is_taken(joins, ports.snapshot)) taken.snapshot = ports.snapshot;
  return taken;
}

std::expected<HostFacts, net::NetError> read_host_facts(const net::HostClock& clock,
                                                        const std::vector<NamedPeer>& peers, const OtherPorts& ports) {
  HostFacts facts;
  auto links = read_links();
  if (!links) return std::unexpected(links.error());
  facts.links = *std::move(links);
  for (Link& link : facts.links) link.strict_sources = drops_by_source(link.name);
  facts.dropped_by_source = counter_of("TcpExt:", "IPReversePathFilter");
  for (const NamedPeer& peer : peers) facts.routes.push_back(route_to(peer));
  facts.memberships_max = number_in("/proc/sys/net/ipv4/igmp_max_memberships");
  facts.optmem_bytes = number_in("/proc/sys/net/core/optmem_max");
  if (const auto os_clock = net::read_os_clock(clock)) facts.clock_error = os_clock->error;
  facts.container = container_here();
  facts.firewall = read_firewall();
  facts.taken = taken_of(ports);
  return facts;
}

}  // namespace peerd::doctor
