#include "peerd/net/doctor/host_facts.hpp"

#include <arpa/inet.h>
#include <linux/netfilter.h>
#include <linux/netfilter/nf_tables.h>
#include <linux/netfilter/nfnetlink.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <string_view>

#include "peerd/net/doctor/netlink.hpp"

namespace peerd::doctor {
namespace {

std::string_view family_name(std::uint8_t family) {
  switch (family) {
    case NFPROTO_INET:
      return "inet";
    case NFPROTO_IPV4:
      return "ip";
    case NFPROTO_IPV6:
      return "ip6";
    default:
      return "";
  }
}

// Numbers of nf_tables are big-endian.
std::uint32_t number_of(const Attribute& a) { return ntohl(a.number<std::uint32_t>()); }

// The name of a chain that sees what arrives for this computer and drops what no rule accepts; else empty.
std::string dropping_chain(std::span<const std::byte> message) {
  nfgenmsg header;
  std::memcpy(&header, message.data(), sizeof header);
  std::string table, name;
  bool sees_input = false, drops = false;
  for_each_attribute(message.subspan(NLMSG_ALIGN(sizeof header)), [&](const Attribute& a) {
    if (a.type == NFTA_CHAIN_TABLE) table = a.text();
    if (a.type == NFTA_CHAIN_NAME) name = a.text();
    if (a.type == NFTA_CHAIN_POLICY) drops = number_of(a) == NF_DROP;
    if (a.type == NFTA_CHAIN_HOOK) {
      for_each_attribute(a.value, [&](const Attribute& hook) {
        if (hook.type == NFTA_HOOK_HOOKNUM) sees_input = number_of(hook) == NF_INET_LOCAL_IN;
      });
    }
  });
  const std::string_view family = family_name(header.nfgen_family);
  if (!sees_input || !drops || family.empty()) return "";
  return std::string(family) + " " + table + " " + name;
}

// Only root reads these files; they list the tables that iptables-legacy has made.
bool has_older_tables() {
  for (const char* file : {"/proc/net/ip_tables_names", "/proc/net/ip6_tables_names"}) {
    std::string table;
    if (std::ifstream(file) >> table) return true;
  }
  return false;
}

}  // namespace

// The chains of nftables, of which the iptables of today is made, too.
Firewall read_firewall() {
  const nfgenmsg all{.nfgen_family = NFPROTO_UNSPEC, .version = NFNETLINK_V0, .res_id = 0};
  Firewall firewall;
  const auto read = dump(NETLINK_NETFILTER, (NFNL_SUBSYS_NFTABLES << 8) | NFT_MSG_GETCHAIN,
                         std::as_bytes(std::span(&all, 1)), [&](std::uint16_t, std::span<const std::byte> message) {
                           if (message.size() < sizeof all) return;
                           if (std::string name = dropping_chain(message); !name.empty())
                             firewall.dropping.push_back(std::move(name));
                         });
  // Any other error means that the kernel has no nf_tables, and so no chains of it.
  firewall.readable = read || read.error() != EPERM;
  firewall.older_tables = has_older_tables();
  return firewall;
}

}  // namespace peerd::doctor
