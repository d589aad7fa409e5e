#pragma once
#include <cstdint>
#include <filesystem>

namespace peerd {

struct ReplayOptions {
  std::filesystem::path file;         // a capture
  std::filesystem::path world;        // place of its world now; empty: where it was
  std::filesystem::path record;       // file for the peer's log; empty: none
  std::uint64_t size_max_mib = 1024;  // a larger capture is refused
  bool json = false;
  bool verbose = false;  // print the peer's log lines
};

// `peerd replay`: runs a recorded peer once more on its recorded inputs. Returns 1 when it does not send what it sent
// then, or the file is no capture. As JSON: peer {id, name}, inputs, datagrams_in, datagrams_out (compared), begin_s,
// duration_s, cut_off (the record ends in the middle of a packet), same, difference (null: none) {packet (0: the end),
// at_s, what}.
[[nodiscard]] int run_replay(const ReplayOptions& options);

}  // namespace peerd
