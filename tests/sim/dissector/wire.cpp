#include "tests/sim/dissector/wire.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "peerd/peer/record/udp_packet.hpp"
#include "tests/net/process.hpp"

namespace peerd::sim::dissector_test {
namespace {

using boost::asio::ip::make_address;
using boost::asio::ip::udp;

constexpr std::size_t kEthernet_bytes = 14, kIp_bytes = 20, kUdp_bytes = 8, kTcp_bytes = 20;
constexpr std::uint8_t kIsTcp = 6, kIsUdp = 17;
// Larger files are read once, which takes seconds enough.
constexpr std::size_t kReadTwice_packets = 500;
constexpr auto kEthernet = static_cast<record::LinkType>(1);

// Numbers of IP have the most significant byte first.
std::size_t number(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  std::size_t value = 0;
  for (const std::byte byte : bytes.subspan(at, size)) value = value << 8 | std::to_integer<std::size_t>(byte);
  return value;
}

void append(std::vector<std::byte>& bytes, std::size_t value, std::size_t size) {
  while (size-- > 0) bytes.push_back(static_cast<std::byte>(value >> (8 * size)));
}

std::string endpoint(std::span<const std::byte> address, std::size_t port) {
  std::string text;
  for (const std::byte byte : address) text += std::to_string(std::to_integer<int>(byte)) + ".";
  return text + ":" + std::to_string(port);
}

}  // namespace

std::vector<WirePacket> wire_packets(std::span<const std::byte> file) {
  std::vector<WirePacket> packets;
  record::PcapngReader reader(file);
  for (std::size_t count = 1;; ++count) {
    const auto next = reader.next();
    if (!next) ADD_FAILURE() << next.error();
    if (!next || !*next) return packets;
    std::span<const std::byte> ip = (*next)->bytes;
    if ((*next)->link == kEthernet) ip = ip.subspan(std::min(kEthernet_bytes, ip.size()));
    if (ip.size() < kIp_bytes || ip[0] != std::byte{0x45}) continue;
    ip = ip.first(std::min(ip.size(), number(ip, 2, 2)));  // Ethernet pads short packets
    const auto protocol = std::to_integer<std::uint8_t>(ip[9]);
    const bool is_tcp = protocol == kIsTcp;
    const auto transport = ip.subspan(kIp_bytes);
    if ((!is_tcp && protocol != kIsUdp) || transport.size() < (is_tcp ? kTcp_bytes : kUdp_bytes)) continue;
    const std::size_t head = is_tcp ? number(transport, 12, 1) / 16 * 4 : kUdp_bytes;
    if (head > transport.size()) continue;
    const std::size_t from_port = number(transport, 0, 2), to_port = number(transport, 2, 2);
    packets.push_back({count, SimTime{(*next)->at.time_since_epoch()}, is_tcp, endpoint(ip.subspan(12, 4), from_port),
                       endpoint(ip.subspan(16, 4), to_port), static_cast<std::uint16_t>(to_port),
                       transport.subspan(head)});
  }
}

WireWriter::WireWriter(const std::filesystem::path& file)
    : file_(file, std::ios::binary), packets_(file_, "a test", "made up") {
  packets_.interface(record::LinkType::kRawIp, "made-up", "no network");
}

void WireWriter::write(std::span<const std::byte> packet) {
  now_ += std::chrono::microseconds(100);
  packets_.packet(0, now_, record::Direction::kUnknown, packet);
}

void WireWriter::udp(std::uint16_t port, std::span<const std::byte> payload) {
  write(record::encode({{make_address("10.0.0.1"), 50'000}, {make_address("239.192.80.0"), port}, payload}));
}

void WireWriter::frame(std::uint16_t connection, bool from_client, std::string_view content, std::size_t most) {
  std::string frame;
  for (int shift = 0; shift < 32; shift += 8) frame += static_cast<char>(content.size() >> shift & 0xff);
  bytes(connection, from_client, frame + std::string(content), most);
}

// Checksums are zeros: tshark does not look at them.
void WireWriter::bytes(std::uint16_t connection, bool from_client, std::string_view content, std::size_t most) {
  std::uint32_t& sent = sent_[{connection, from_client}];
  const std::uint32_t acknowledged = sent_[{connection, !from_client}];
  while (!content.empty()) {
    const std::string_view segment = content.substr(0, most);
    content.remove_prefix(segment.size());
    std::vector<std::byte> packet;
    append(packet, 0x4500, 2);
    append(packet, kIp_bytes + kTcp_bytes + segment.size(), 2);
    append(packet, 0, 4);
    append(packet, 64 << 8 | kIsTcp, 2);
    append(packet, 0, 2);
    append(packet, from_client ? 0x0A000002 : 0x0A000001, 4);
    append(packet, from_client ? 0x0A000001 : 0x0A000002, 4);
    append(packet, from_client ? connection : kJoinPort, 2);
    append(packet, from_client ? kJoinPort : connection, 2);
    append(packet, 1 + sent, 4);
    append(packet, 1 + acknowledged, 4);
    append(packet, 0x5018, 2);  // five words of header; PSH, ACK
    append(packet, 0xFFFF, 2);
    append(packet, 0, 4);
    const auto payload = std::as_bytes(std::span(segment));
    packet.insert(packet.end(), payload.begin(), payload.end());
    write(packet);
    sent += static_cast<std::uint32_t>(segment.size());
  }
}

void compare_wire(const peerd::testing_support::ScratchFolder& folder, const std::filesystem::path& file,
                  std::map<std::string, std::size_t>& seen, const std::vector<replication::OperationPart>& known) {
  const auto packets = dissected(folder, file);
  if (packets.size() < kReadTwice_packets) {
    EXPECT_EQ(dissected(folder, file, {}, true), packets) << "a second reading of the file shows something else";
  }
  const std::string bytes = peerd::testing_support::text_of(file);
  Readers readers;
  for (const auto& part : known) readers.learn(part);
  std::set<std::string> clients;
  std::size_t compared = 0;
  std::vector<std::string> differences;
  for (const WirePacket& packet : wire_packets(std::as_bytes(std::span(bytes)))) {
    if (packet.payload.empty()) continue;
    Fields ours;
    if (packet.is_tcp) {
      const std::string there = packet.from + ">" + packet.to, back = packet.to + ">" + packet.from;
      const bool from_client = !clients.contains(back);
      if (from_client) clients.insert(there);
      const std::string_view text(reinterpret_cast<const char*>(packet.payload.data()), packet.payload.size());
      ours = readers.segment(from_client ? there : back, from_client, text, packet.number);
    } else if (packet.to_port == kDiscoveryPort) {
      ours = Readers::discovery(packet.payload);
    } else if (packet.to_port == kSessionPort) {
      ours = readers.datagram(packet.payload, RegionId{0}, packet.at);
    }
    if (ours.empty()) continue;
    ++compared;
    const auto theirs = packets.find(packet.number);
    const std::string what = theirs == packets.end() ? "nothing to tshark" : difference(ours, theirs->second);
    if (!what.empty()) {
      differences.push_back("packet " + std::to_string(packet.number) + ": " + what + ": " + hex(packet.payload));
    }
    for (const auto& [name, values] : ours) seen[name] += values.size();
    if (theirs != packets.end() && theirs->second.contains(kUnknown)) ++seen[kUnknown];
  }
  EXPECT_EQ(compared, packets.size());
  EXPECT_THAT(differences, testing::IsEmpty()) << file;
}

}  // namespace peerd::sim::dissector_test
