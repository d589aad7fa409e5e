#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace peerd {

// The options that `peerd sim` and `peerd scenario` share.
struct ScenarioOptions {
  std::filesystem::path scenario;
  std::vector<std::filesystem::path> configs;
  std::vector<std::string> sets;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> repeat;  // with so many seeds
  std::filesystem::path out;            // empty: out/NAME
  std::string interface;                // real runs only
  bool netem = false;                   // .. over the network that the scenario describes, by the kernel's netem
  bool tcpdump = false;                 // .. with what each peer sent and got, as a file for tcpdump or Wireshark
  std::filesystem::path captures;       // simulated runs only: a folder for each peer's capture; empty: none
  bool json = false;                    // summary.json instead of the table
  bool verbose = false;                 // the peers' logs too
};

}  // namespace peerd
