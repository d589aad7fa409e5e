#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace peerd {

struct DoctorOptions {
  std::filesystem::path config;   // whose table [transport] counts; empty: the defaults
  std::vector<std::string> sets;  // over it
  bool json = false;
};

// peerd doctor: whether a peer could reach others from here, and how. 3 when it could not. As JSON: interface {name,
// why} (null: none), multicast {tried, works, took_us, kernel_stamps | problem}, memberships_of_a_socket (null: not by
// number), receive_buffer_bytes {asked, granted}, unicast_needed, unicast_peers, transport ("multicast", "unicast",
// null), problem.
[[nodiscard]] int run_doctor(const DoctorOptions& options);

}  // namespace peerd
