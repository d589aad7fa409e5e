// Reads any file as a capture: all spans lie within the file, times never decrease, and the packets survive writing and
// reading.
#include <cstdint>
#include <span>
#include <sstream>

#include "peerd/peer/record/capture.hpp"
#include "peerd/peer/record/udp_packet.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;
using namespace peerd::record;

void require_within(std::span<const std::byte> part, std::span<const std::byte> whole) {
  require(part.empty() || (part.data() >= whole.data() && part.data() + part.size() <= whole.data() + whole.size()));
}

void read_packets(std::span<const std::byte> file) {
  std::ostringstream copy;
  PcapngWriter writer(copy, "fuzz", "");
  writer.interface(LinkType::kRawIp, "network", "");
  std::vector<PcapngPacket> packets;
  PcapngReader reader(file);
  for (auto packet = reader.next(); packet && *packet; packet = reader.next()) {
    require_within((*packet)->bytes, file);
    writer.packet(0, (*packet)->at, (*packet)->direction, (*packet)->bytes);
    packets.push_back(**packet);
    if (const auto udp = decode_udp_packet((*packet)->bytes)) require_within(udp->payload, file);
  }
  const std::string text = copy.str();
  PcapngReader again(std::as_bytes(std::span(text)));
  for (const PcapngPacket& packet : packets) {
    const auto same = again.next();
    require(same && *same && (*same)->at == packet.at && (*same)->direction == packet.direction &&
            std::ranges::equal((*same)->bytes, packet.bytes));
  }
  const auto end = again.next();
  require(end && !*end && !again.cut_off());
}

void read_events(std::span<const std::byte> file) {
  auto capture = CaptureReader::open(file);
  if (!capture) return;
  const auto again = setup_from(to_text(capture->setup()));
  require(again.has_value() && to_text(*again) == to_text(capture->setup()));
  HostTime last = capture->begin();
  for (auto event = capture->next(); event && *event; event = capture->next()) {
    require((*event)->at >= last);
    last = (*event)->at;
    if (const auto* in = std::get_if<DatagramIn>(&(*event)->what)) require_within(in->datagram, file);
    if (const auto* poses = std::get_if<Poses>(&(*event)->what)) {
      require_within(std::as_bytes(std::span(poses->datagram)), file);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = std::as_bytes(std::span(data, size));
  read_packets(file);
  read_events(file);
  return 0;
}
