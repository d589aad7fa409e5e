#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/dissector/expected.hpp"

namespace peerd::sim::dissector_test {

inline constexpr const char* kTshark = "/usr/bin/tshark";
inline constexpr const char* kNoTshark = "no tshark: scripts/test --full installs it (apt-get install tshark)";

// The numbers of fields of Protobuf that the dissector does not know.
inline constexpr const char* kUnknown = "peerd.unknown_field";

// The names of all fields of session datagrams, of discovery, of joins, and of what goes to and from relays.
[[nodiscard]] std::vector<std::string> fields_of_datagrams();
[[nodiscard]] std::vector<std::string> fields_of_discovery();
[[nodiscard]] std::vector<std::string> fields_of_joins();
[[nodiscard]] std::vector<std::string> fields_of_links();

// The packets in which tshark finds one of these three, by their numbers from 1. A preference is "NAME:VALUE". An error
// of the dissector itself fails the test. `twice`: tshark reads the file twice, as Wireshark does.
[[nodiscard]] std::map<std::size_t, Fields> dissected(const peerd::testing_support::ScratchFolder& folder,
                                                      const std::filesystem::path& file,
                                                      const std::vector<std::string>& preferences = {},
                                                      bool twice = false);

// In what a packet is not to tshark what it should be; empty: in nothing.
[[nodiscard]] std::string difference(const Fields& ours, Fields theirs);

}  // namespace peerd::sim::dissector_test
