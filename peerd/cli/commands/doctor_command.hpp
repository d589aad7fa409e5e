#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace peerd {

struct DoctorOptions {
  std::filesystem::path config;   // file whose table [transport] is used; empty: the defaults
  std::vector<std::string> sets;  // KEY=VALUE over it
  std::string with;               // HOST or HOST:PORT of another computer where it runs, too; empty: none
  double wait_s = 60.0;           // for it to start there
  bool json = false;
};

// `peerd doctor`: tries whether a peer could reach others from here, and how. Returns 0 when it could reach other
// computers by what was seen, 1 when it would reach this computer only or something will hurt, and 3 when it could not
// run. As JSON: interface {name, why} (null: none), multicast {tried, works, took_us, kernel_stamps | problem},
// memberships_of_a_socket (null: not limited by number), receive_buffer_bytes {asked, granted}, unicast_needed,
// only_this_computer, unicast_peers, transport ("multicast", "unicast", null), findings [{name, level, sentence,
// advice}] (peerd/net/doctor), problem.
//
// With another computer its findings are what both have seen of each other: 0 multicast works both ways, 1 only unicast
// does, or something will hurt, 3 nothing does. JSON gets the member with (doctor::PairOutcome).
[[nodiscard]] int run_doctor(const DoctorOptions& options);

}  // namespace peerd
