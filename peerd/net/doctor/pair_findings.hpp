#pragma once
#include <vector>

#include "peerd/net/doctor/finding.hpp"
#include "peerd/net/doctor/pair_run.hpp"

namespace peerd::doctor {

// What follows for peers on the two computers: a pure function. The worst finding is the exit code: 0 multicast works
// both ways (or unicast, where multicast is switched off), 1 unicast alone does, or something will hurt, 3 nothing
// does.
[[nodiscard]] std::vector<Finding> pair_findings(const PairOutcome& outcome);

// Whether something arrived both ways: by multicast; by multicast or by unicast.
[[nodiscard]] bool multicast_works(const PairOutcome& outcome);
[[nodiscard]] bool any_path_works(const PairOutcome& outcome);

// {host, address, answered, is_heard, multicast: {tried, interface, to, from}, unicast: {to, from}, tcp: {to, from},
// round_trip_ms, clock_ahead_ms}; to and from of datagrams are {arrived, of, largest_bytes}, of TCP "works", "refused",
// "no answer" or "untried".
[[nodiscard]] nlohmann::ordered_json as_json(const PairOutcome& outcome);

}  // namespace peerd::doctor
