#pragma once
#include <array>
#include <expected>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/peer/record/pcapng.hpp"
#include "peerd/peer/record/setup.hpp"
#include "replication/session/session_clock.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::record {

// Writes a capture: every input of one PeerNode, in its order and with the times that the node got, and the datagrams
// that the node sent; or, sealed, datagrams alone. README.md in this folder specifies the file. What was sealed and is
// not any more only this user may read.
//
// Each call precedes the corresponding call of the node; on_send() is called where the node's outputs are polled. After
// a write error the capture has ended for good, and good() is false.
class CaptureWriter {
 public:
  // `own_address` is the source of the peer's datagrams, or the unspecified address where there are several.
  [[nodiscard]] static Result<std::unique_ptr<CaptureWriter>> open(const std::filesystem::path& path,
                                                                   const Setup& setup, HostTime now,
                                                                   const boost::asio::ip::address& own_address);

  void on_packet(HostTime now, const boost::asio::ip::udp::endpoint& from, RegionId region,
                 std::span<const std::byte> datagram);
  void on_tick(HostTime now) { input(now, "tick"); }
  void on_os_clock(HostTime now, const std::optional<replication::OsClock>& clock);
  void on_control(HostTime now, Duration host_minus_wall, std::string_view line);
  void on_poses(HostTime now, Duration host_minus_wall, std::string_view datagram);
  // The members are those of that roster from now on.
  void on_roster(HostTime now, std::string_view roster) { input(now, "roster " + std::string(roster)); }
  void on_leave(HostTime now) { input(now, "leave"); }
  // The peer has signed an operation, which the last input has made.
  void on_signed(std::span<const std::byte, replication::kSignature_bytes> signature);
  // The datagram has the time of the last input, which has caused it; or, where no inputs are captured, the time given.
  void on_send(RegionId region, std::span<const std::byte> datagram);
  void on_send(HostTime now, RegionId region, std::span<const std::byte> datagram);
  // Passes everything to the operating system, so that it outlives this process.
  void flush() { file_.flush(); }
  [[nodiscard]] bool good() const { return file_.good(); }

 private:
  CaptureWriter(const std::filesystem::path& path, const Setup& setup, HostTime now,
                const boost::asio::ip::address& own_address);
  void datagram(Direction direction, const boost::asio::ip::udp::endpoint& from, RegionId region,
                std::span<const std::byte> bytes);
  void input(HostTime now, std::string_view text);

  std::ostream& opened(const std::filesystem::path& path, Setup::Datagrams datagrams);

  std::vector<char> buffer_;  // used by file_
  std::ofstream file_;
  PcapngWriter packets_;
  net::GroupPlan groups_;
  boost::asio::ip::udp::endpoint own_;
  HostTime now_;
};

// The events of a capture. Spans and views point into its bytes.
struct DatagramIn {
  RegionId region;
  std::span<const std::byte> datagram;
};
struct DatagramOut {
  RegionId region;
  std::span<const std::byte> datagram;
};
struct Tick {};
struct OsClockRead {  // none: the system knows no error bound
  std::optional<replication::OsClock> clock;
};
struct Control {  // one line of the control protocol
  Duration host_minus_wall;
  std::string_view line;
};
struct Poses {  // one datagram of the pose port
  Duration host_minus_wall;
  std::string_view datagram;
};
struct RosterRead {
  std::string_view text;
};
struct Left {};
struct Signed {  // by the peer, whose secret no capture has
  std::array<std::byte, replication::kSignature_bytes> signature{};
};
struct Event {
  HostTime at;
  std::variant<DatagramIn, DatagramOut, Tick, OsClockRead, Control, Poses, RosterRead, Left, Signed> what;
};

// Reads a capture, which is hostile input. Errors are sentences that say where.
class CaptureReader {
 public:
  // `file` outlives the reader and its events.
  [[nodiscard]] static std::expected<CaptureReader, std::string> open(std::span<const std::byte> file);

  [[nodiscard]] const Setup& setup() const { return setup_; }
  // The time at which the peer was made.
  [[nodiscard]] HostTime begin() const { return begin_; }
  // Returns the next event, and none at the end. A file whose times decrease is an error.
  [[nodiscard]] std::expected<std::optional<Event>, std::string> next();
  // After the end: whether the file stops inside of a packet, because its writer was stopped.
  [[nodiscard]] bool cut_off() const { return packets_.cut_off(); }

 private:
  explicit CaptureReader(std::span<const std::byte> file) : packets_(file) {}
  [[nodiscard]] std::expected<Event, std::string> take_datagram(const PcapngPacket& packet) const;

  PcapngReader packets_;
  Setup setup_;
  HostTime begin_{}, last_{};
  std::size_t count_ = 0;  // packets
};

// All that the peer has signed, in its order, as far as the capture can be read.
[[nodiscard]] std::vector<Signed> signatures_in(std::span<const std::byte> file);

}  // namespace peerd::record
