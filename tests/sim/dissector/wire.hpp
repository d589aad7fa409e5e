#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "peerd/peer/record/pcapng.hpp"
#include "tests/sim/dissector/tshark.hpp"

namespace peerd::sim::dissector_test {

// A packet of UDP or TCP over IPv4, as it was on the wire.
struct WirePacket {
  std::size_t number;  // in the file, from 1
  SimTime at;
  bool is_tcp;
  std::string from, to;  // addresses and ports
  std::uint16_t to_port;
  std::span<const std::byte> payload;
};

// All of a file of Ethernet or raw IP packets; others are left out. A file that cannot be read fails the test.
[[nodiscard]] std::vector<WirePacket> wire_packets(std::span<const std::byte> file);

inline constexpr std::uint16_t kSessionPort = 47474, kDiscoveryPort = 47473, kJoinPort = 46123;

// Writes a file of such packets.
class WireWriter {
 public:
  explicit WireWriter(const std::filesystem::path& file);

  void datagram(std::span<const std::byte> payload) { udp(kSessionPort, payload); }
  void discovery(std::span<const std::byte> payload) { udp(kDiscoveryPort, payload); }
  // Sends a message from one side of a TCP connection, whose number is the client's port, with its length before it
  // and in segments of `most` bytes.
  void frame(std::uint16_t connection, bool from_client, std::string_view content, std::size_t most = 1400);
  void bytes(std::uint16_t connection, bool from_client, std::string_view content, std::size_t most = 1400);
  void flush() { file_.flush(); }

 private:
  void udp(std::uint16_t port, std::span<const std::byte> payload);
  void write(std::span<const std::byte> packet);

  std::ofstream file_;
  record::PcapngWriter packets_;
  HostTime now_{std::chrono::seconds(10'000'003)};
  std::map<std::pair<std::uint16_t, bool>, std::uint32_t> sent_;  // by connection and side
};

// Compares what tshark finds in all packets of a file with what our own readers find in them. `seen` counts the values
// of each field, and of kUnknown. `known` are parts of logs that tshark has to do without.
void compare_wire(const peerd::testing_support::ScratchFolder& folder, const std::filesystem::path& file,
                  std::map<std::string, std::size_t>& seen, const std::vector<replication::OperationPart>& known = {});

}  // namespace peerd::sim::dissector_test
