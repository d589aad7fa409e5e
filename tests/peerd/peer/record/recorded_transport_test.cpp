#include "peerd/peer/record/recorded_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::record::recorded_transport_test {

namespace ip = boost::asio::ip;

// A network of one peer: what it sends comes back when it is read, an instant before it was sent.
class Loop final : public net::Transport {
 public:
  void on_receive(ReceiveHandler handler) override { handler_ = std::move(handler); }
  bool receive_pending() override {
    for (const auto& [region, bytes] : std::exchange(sent_, {})) handler_({region, bytes, kAt, from_});
    return true;
  }
  std::expected<void, net::NetError> join(RegionId) override { return {}; }
  std::expected<void, net::NetError> leave(RegionId) override { return {}; }
  void send(RegionId region, std::span<const std::byte> bytes) override {
    sent_.emplace_back(region, std::vector(bytes.begin(), bytes.end()));
  }
  void flush() override {}
  [[nodiscard]] std::optional<net::InterfaceChange> follow_interface() override { return std::nullopt; }
  [[nodiscard]] const net::TrafficCounters& counters() const override { return counters_; }
  [[nodiscard]] std::size_t joined_count() const override { return 0; }
  [[nodiscard]] int receive_buffer_bytes() const override { return 0; }
  [[nodiscard]] ip::address own_address() const override { return from_.address(); }
  [[nodiscard]] std::string describe() const override { return "loop"; }

  static constexpr HostTime kAt{Duration{90}};

 private:
  ip::udp::endpoint from_{ip::make_address("192.0.2.1"), 4000};
  std::vector<std::pair<RegionId, std::vector<std::byte>>> sent_;
  ReceiveHandler handler_;
  net::TrafficCounters counters_;
};

TEST(RecordedTransports, WriteWhatPassesThemInTheOrderOfTime) {
  const testing_support::ScratchFolder folder;
  record::Setup setup;  // GoogleTest has one, too
  setup.peer = "a";
  setup.groups = {.base = ip::make_address("239.192.0.0"), .port = 47474};
  setup.datagrams = record::Setup::Datagrams::kSealed;
  auto capture = must(CaptureWriter::open(folder / "c", setup, HostTime{Duration{10}}, ip::make_address("192.0.2.1")));
  RecordedTransport transport(std::make_unique<Loop>(), *capture, [] { return HostTime{Duration{100}}; });
  std::vector<std::byte> heard;
  transport.on_receive(
      [&](const net::Arrival& arrival) { heard.assign(arrival.datagram.begin(), arrival.datagram.end()); });
  const std::vector datagram(3, std::byte{0x80});
  transport.send(RegionId{2}, datagram);
  transport.flush();
  EXPECT_TRUE(transport.receive_pending());
  EXPECT_EQ(heard, datagram);

  const std::string file = testing_support::text_of(folder / "c");
  EXPECT_NE(file.find("sealed as they were on the network"), std::string::npos) << "its comment";
  PcapngReader reader(std::as_bytes(std::span(file)));
  std::vector<PcapngPacket> packets;
  while (const auto packet = reader.next()) {
    if (!*packet) break;
    packets.push_back(**packet);
  }
  ASSERT_EQ(packets.size(), 3u);
  for (const std::size_t i : {1, 2}) {
    EXPECT_EQ(packets[i].at, HostTime{Duration{100}});
    EXPECT_EQ(packets[i].direction, i == 1 ? Direction::kOut : Direction::kIn);
    EXPECT_TRUE(std::ranges::equal(packets[i].bytes.last(3), datagram));
  }
  EXPECT_THAT(error_of(CaptureReader::open(std::as_bytes(std::span(file)))),
              testing::HasSubstr("peerd record --opened"));
}

}  // namespace peerd::record::recorded_transport_test
