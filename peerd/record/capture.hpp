#pragma once
#include <expected>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/record/pcapng.hpp"
#include "peerd/record/setup.hpp"
#include "replication/session/session_clock.hpp"

namespace peerd::record {

// A capture: everything that went into one PeerNode, in that order, with the times that it was told, and the datagrams
// that came out. README.md in this folder has the file's format.
//
// Each call stands before the node's, on_send() where its outputs are polled. What can't be written ends the capture
// for good, and good() says so.
class CaptureWriter {
 public:
  // own_address: where the peer's datagrams come from; any address where that is not one alone.
  [[nodiscard]] static Result<std::unique_ptr<CaptureWriter>> open(const std::filesystem::path& path,
                                                                           const Setup& setup, HostTime now,
                                                                           const boost::asio::ip::address& own_address);

  void on_packet(HostTime now, const boost::asio::ip::udp::endpoint& from, RegionId region,
                 std::span<const std::byte> datagram);
  void on_tick(HostTime now) { input(now, "tick"); }
  void on_os_clock(HostTime now, const std::optional<replication::OsClock>& clock);
  void on_control(HostTime now, Duration host_minus_wall, std::string_view line);
  void on_poses(HostTime now, Duration host_minus_wall, std::string_view datagram);
  void on_leave(HostTime now) { input(now, "leave"); }
  // At the time of the last input, which it answers.
  void on_send(RegionId region, std::span<const std::byte> datagram);
  // Hands what is written to the system, so that it outlives this process.
  void flush() { file_.flush(); }
  [[nodiscard]] bool good() const { return file_.good(); }

 private:
  CaptureWriter(const std::filesystem::path& path, const Setup& setup, HostTime now,
                const boost::asio::ip::address& own_address);
  void datagram(Direction direction, const boost::asio::ip::udp::endpoint& from, RegionId region,
                std::span<const std::byte> bytes);
  void input(HostTime now, std::string_view text);

  std::ostream& opened(const std::filesystem::path& path);

  std::vector<char> buffer_;  // of file_
  std::ofstream file_;
  PcapngWriter packets_;
  net::GroupPlan groups_;
  boost::asio::ip::udp::endpoint own_;
  HostTime now_;
};

// What stands in a capture. Spans and views point into its bytes.
struct DatagramIn {
  RegionId region;
  std::span<const std::byte> datagram;
};
struct DatagramOut {
  RegionId region;
  std::span<const std::byte> datagram;
};
struct Tick {};
struct OsClockRead {  // none: it does not know how right it is
  std::optional<replication::OsClock> clock;
};
struct Control {  // a line of the control protocol
  Duration host_minus_wall;
  std::string_view line;
};
struct Poses {  // a datagram at the port for poses
  Duration host_minus_wall;
  std::string_view datagram;
};
struct Left {};
struct Event {
  HostTime at;
  std::variant<DatagramIn, DatagramOut, Tick, OsClockRead, Control, Poses, Left> what;
};

// Hostile input: errors are sentences that say where.
class CaptureReader {
 public:
  // `file` outlives the reader and its events.
  [[nodiscard]] static std::expected<CaptureReader, std::string> open(std::span<const std::byte> file);

  [[nodiscard]] const Setup& setup() const { return setup_; }
  // When the peer was made.
  [[nodiscard]] HostTime begin() const { return begin_; }
  // None at the end. Times never go back.
  [[nodiscard]] std::expected<std::optional<Event>, std::string> next();
  // After the end: the writer was stopped in the middle.
  [[nodiscard]] bool cut_off() const { return packets_.cut_off(); }

 private:
  explicit CaptureReader(std::span<const std::byte> file) : packets_(file) {}
  [[nodiscard]] std::expected<Event, std::string> take_datagram(const PcapngPacket& packet) const;

  PcapngReader packets_;
  Setup setup_;
  HostTime begin_{}, last_{};
  std::size_t count_ = 0;  // packets
};

}  // namespace peerd::record
