#include "peerd/peer/record/capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/peer/record/some_setup.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::record::capture_test {

namespace ip = boost::asio::ip;
using peerd::testing_support::ScratchFolder;
using peerd::testing_support::text_of;
using testing::HasSubstr;

std::string as_text(const Event& event) {
  const auto text = [](std::span<const std::byte> b) {
    return std::string(reinterpret_cast<const char*>(b.data()), b.size());
  };
  std::string line = std::to_string(event.at.time_since_epoch().count());
  if (const auto* in = std::get_if<DatagramIn>(&event.what)) {
    line += " in " + std::to_string(in->region.value) + " " + text(in->datagram);
  } else if (const auto* out = std::get_if<DatagramOut>(&event.what)) {
    line += " out " + std::to_string(out->region.value) + " " + text(out->datagram);
  } else if (const auto* control = std::get_if<Control>(&event.what)) {
    line += " control " + std::to_string(control->host_minus_wall.count()) + " " + std::string(control->line);
  } else if (const auto* poses = std::get_if<Poses>(&event.what)) {
    line += " poses " + std::to_string(poses->host_minus_wall.count()) + " " + std::string(poses->datagram);
  } else {
    line += std::holds_alternative<Tick>(event.what) ? " tick" : " left";
  }
  return line;
}

struct Groups {
  const char *name, *base;
  std::uint32_t pool;
};
class Capture : public testing::TestWithParam<Groups> {};

// Regions are found from groups, and from the datagrams themselves where regions share groups, even for a datagram that
// begins as a region header does.
TEST_P(Capture, WhatIsWrittenIsRead) {
  const char* const base = GetParam().base;
  const std::uint32_t pool = GetParam().pool;
  const ScratchFolder folder;
  const record::Setup setup = some_setup({ip::make_address(base), 47474, pool});
  const bool v4 = setup.groups.base.is_v4();
  const ip::udp::endpoint from(ip::make_address(v4 ? "192.0.2.7" : "2001:db8::7"), 1234);
  const auto bytes = [](std::string_view text) { return std::as_bytes(std::span(text)); };
  {
    auto opened = must(CaptureWriter::open(folder / "c", setup, HostTime{Duration{10}}, from.address()));
    CaptureWriter& writer = *opened;
    writer.on_send(RegionId{0}, bytes("joins"));
    writer.on_tick(HostTime{Duration{11}});
    writer.on_packet(HostTime{Duration{12}}, from, RegionId{300}, bytes("R12345"));
    writer.on_send(RegionId{65'536}, bytes("answer"));
    writer.on_control(HostTime{Duration{12}}, Duration{-7}, "{\"do\": \"status\"} \t");
    writer.on_poses(HostTime{Duration{13}}, Duration{8}, std::string_view("\0 \n\xFF", 4));
    writer.on_poses(HostTime{Duration{13}}, Duration{8}, "");
    writer.on_leave(HostTime{Duration{14}});
    EXPECT_TRUE(writer.good());
  }
  const std::string file = text_of(folder / "c");
  auto reader = must(CaptureReader::open(std::as_bytes(std::span(file))));
  EXPECT_EQ(to_text(reader.setup()), to_text(setup));
  EXPECT_EQ(reader.setup().options.wait_for, setup.options.wait_for);
  EXPECT_EQ(reader.begin(), HostTime{Duration{10}});
  std::vector<std::string> lines;
  for (;;) {
    const auto event = must(reader.next());
    if (!event) break;
    lines.push_back(as_text(*event));
  }
  EXPECT_THAT(lines, testing::ElementsAre("10 out 0 joins", "11 tick", "12 in 300 R12345", "12 out 65536 answer",
                                          "12 control -7 {\"do\": \"status\"} \t",
                                          "13 poses 8 " + std::string("\0 \n\xFF", 4), "13 poses 8 ", "14 left"));
  EXPECT_FALSE(reader.cut_off());
}
INSTANTIATE_TEST_SUITE_P(Groups, Capture,
                         testing::Values(Groups{"Ipv4", "239.192.0.0", 0}, Groups{"Ipv4Pool", "239.192.0.0", 4},
                                         Groups{"Unicast", "239.192.0.0", 1}, Groups{"Ipv6", "ff15::1:0:0", 0},
                                         Groups{"Ipv6Pool", "ff15::1:0:0", 9}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(CaptureFile, CantBeWrittenWhereThereIsNoFolder) {
  const ScratchFolder folder;
  EXPECT_EQ(error_of(CaptureWriter::open(folder / "no" / "c", some_setup({ip::make_address("239.192.0.0"), 47474}),
                                         HostTime{}, ip::make_address("127.0.0.1")))
                .exit_code,
            3);
}

TEST(CaptureFile, AFullDiskEndsTheCaptureAndSaysSo) {
  auto opened = CaptureWriter::open("/dev/full", some_setup({ip::make_address("239.192.0.0"), 47474}), HostTime{},
                                    ip::address_v4::any());
  EXPECT_FALSE(opened);
}

TEST(CaptureFile, OfSomebodyElseIsRefused) {
  std::ostringstream out;
  PcapngWriter writer(out, "somebody", "");
  writer.interface(LinkType::kRawIp, "eth0", "");
  writer.packet(0, HostTime{}, Direction::kIn, {});
  const std::string file = out.str();
  EXPECT_THAT(error_of(CaptureReader::open(std::as_bytes(std::span(file)))), HasSubstr("no capture of peerd's"));
}

// A capture whose inputs have the given times [ns]. Its setup, packet 1, has time 10.
std::string file_with_times(std::initializer_list<std::int64_t> times_ns) {
  std::ostringstream out;
  PcapngWriter writer(out, "peerd", "");
  writer.interface(LinkType::kRawIp, "network", "");
  writer.interface(LinkType::kUser0, "inputs", "");
  const auto input = [&](std::int64_t ns, const std::string& text) {
    writer.packet(1, HostTime{Duration{ns}}, Direction::kIn, std::as_bytes(std::span(text)));
  };
  input(10, "peer " + to_text(some_setup({ip::make_address("239.192.0.0"), 47474})));
  for (const std::int64_t ns : times_ns) input(ns, "tick");
  return out.str();
}

TEST(CaptureFile, WhoseTimesDecreaseIsRefused) {
  const auto error_of = [](std::initializer_list<std::int64_t> times_ns) {
    const std::string file = file_with_times(times_ns);
    auto reader = must(CaptureReader::open(std::as_bytes(std::span(file))));
    for (;;) {
      const auto event = reader.next();
      if (!event) return event.error();
      if (!*event) return std::string();
    }
  };
  EXPECT_EQ(error_of({10, 10, 11, 11}), "") << "equal times are in order";
  EXPECT_EQ(error_of({11, 10}), "packet 3: its time is before that of the one before");
  EXPECT_EQ(error_of({12, 13, 12}), "packet 4: its time is before that of the one before");
  EXPECT_EQ(error_of({9}), "packet 2: its time is before that of the one before") << "before the peer was made";
}

}  // namespace peerd::record::capture_test
