// Facts of computers that do not exist, and what is found of them.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "peerd/net/doctor/host_findings.hpp"

namespace peerd::doctor::testing_support {

using Transport = Examined::Transport;

inline Link ethernet(const std::string& name, unsigned index) {
  return {.name = name, .index = index, .mtu_bytes = 1500, .up = true, .has_carrier = true, .multicast = true};
}

inline HostFacts facts_with(const std::vector<Link>& links) {
  HostFacts facts;
  facts.links = {{.name = "lo", .index = 1, .mtu_bytes = 65536, .up = true, .has_carrier = true, .loopback = true}};
  facts.links.insert(facts.links.end(), links.begin(), links.end());
  facts.clock_error = std::chrono::milliseconds(2);
  facts.firewall.readable = true;
  facts.memberships_max = 20;
  return facts;
}

inline Examined multicast_over(const std::string& interface) {
  return {.transport = Transport::kMulticast,
          .interface = interface,
          .why_interface = interface + ", as configured",
          .port = 47474};
}

inline Examined unicast() { return {.transport = Transport::kUnicast, .port = 47474}; }

inline int code(const HostFacts& facts, const Examined& examined) {
  return exit_code_of(host_findings(facts, examined));
}

// The one of that name; fails the test where there is none.
inline Finding find(const std::vector<Finding>& findings, const std::string& name) {
  const auto found = std::ranges::find(findings, name, &Finding::name);
  if (found != findings.end()) return *found;
  ADD_FAILURE() << "no finding named " << name;
  return {};
}

}  // namespace peerd::doctor::testing_support
