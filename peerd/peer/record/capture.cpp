#include "peerd/peer/record/capture.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <vector>

#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/keys/base64.hpp"
#include "peerd/net/keys/little_endian.hpp"
#include "peerd/peer/record/udp_packet.hpp"

namespace peerd::record {
namespace {

namespace ip = boost::asio::ip;

// More than one input and its outputs take [bytes], so that they reach the file by one system call, all or nothing.
constexpr std::size_t kBuffer_bytes = std::size_t{1} << 20;

constexpr std::uint32_t kNetwork = 0, kInputs = 1;  // the capture's interfaces

// As on the wire, a datagram begins with its region where regions share groups.
bool framed(const net::GroupPlan& groups) { return groups.pool > 0; }

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }
std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Splits "WORD REST", or WORD alone, and leaves REST in `text`.
std::string_view take_word(std::string_view& text) {
  const std::size_t blank = text.find(' ');
  const std::string_view word = text.substr(0, blank);
  text = blank == std::string_view::npos ? std::string_view{} : text.substr(blank + 1);
  return word;
}

std::optional<Duration> take_duration(std::string_view& text) {
  const std::string_view word = take_word(text);
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), ns);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return Duration{ns};
}

std::optional<decltype(Event::what)> input_from(std::string_view text) {
  const std::string_view word = take_word(text);
  if (word == "tick" && text.empty()) return Tick{};
  if (word == "leave" && text.empty()) return Left{};
  if (word == "os-clock" && text.empty()) return OsClockRead{};
  if (word == "os-clock") {
    const auto minus_host = take_duration(text), error = take_duration(text);
    if (!minus_host || !error || !text.empty()) return std::nullopt;
    return OsClockRead{replication::OsClock{*minus_host, *error}};
  }
  if (word == "signed") {
    Signed by_peer;
    const auto size = keys::read_base64(text, keys::as_octets(std::span<std::byte>(by_peer.signature)));
    return size == by_peer.signature.size() ? std::optional(by_peer) : std::nullopt;
  }
  if (word == "roster") return RosterRead{text};
  if (word != "control" && word != "poses") return std::nullopt;
  const auto host_minus_wall = take_duration(text);
  if (!host_minus_wall) return std::nullopt;
  if (word == "control") return Control{*host_minus_wall, text};
  return Poses{*host_minus_wall, text};
}

std::string comment_of(const Setup& setup) {
  switch (setup.datagrams) {
    case Setup::Datagrams::kSealed:
      return "What peer " + setup.peer +
             " heard and sent, datagrams sealed as they were on the network; peerd record --opened has what they say";
    case Setup::Datagrams::kOpened:
      return "All that peer " + setup.peer +
             " heard, was told and sent, opened: as secret as the session's key; peerd replay runs it again";
    case Setup::Datagrams::kOpen:
      break;
  }
  return "All that peer " + setup.peer + " heard, was told and sent; peerd replay runs it again";
}

}  // namespace

Result<std::unique_ptr<CaptureWriter>> CaptureWriter::open(const std::filesystem::path& path, const Setup& setup,
                                                           HostTime now, const ip::address& own_address) {
  std::unique_ptr<CaptureWriter> writer(new CaptureWriter(path, setup, now, own_address));
  writer->flush();
  if (!writer->good()) return std::unexpected(InputError{path.string() + ": error: can't be written", kSystemFailed});
  return writer;
}

CaptureWriter::CaptureWriter(const std::filesystem::path& path, const Setup& setup, HostTime now,
                             const ip::address& own_address)
    : buffer_(kBuffer_bytes),
      packets_(opened(path, setup.datagrams), "peerd", comment_of(setup)),
      groups_(setup.groups),
      own_(own_address, setup.groups.port),
      now_(now) {
  packets_.interface(LinkType::kRawIp, "network", "datagrams, at the times that the peer was told");
  packets_.interface(LinkType::kUser0, "inputs", "what the peer is made of and what else it was told");
  input(now, "peer " + to_text(setup));
}

std::ostream& CaptureWriter::opened(const std::filesystem::path& path, Setup::Datagrams datagrams) {
  // A file that is there already may have been made for others to read. Where this fails, so does what follows.
  if (datagrams == Setup::Datagrams::kOpened) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR);
    if (file >= 0) {
      if (::fchmod(file, S_IRUSR | S_IWUSR) != 0) file_.setstate(std::ios::badbit);
      ::close(file);
    }
  }
  file_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  file_.open(path, std::ios::binary);
  return file_;
}

void CaptureWriter::on_packet(HostTime now, const ip::udp::endpoint& from, RegionId region,
                              std::span<const std::byte> bytes) {
  now_ = now;
  datagram(Direction::kIn, from, region, bytes);
}

void CaptureWriter::on_send(RegionId region, std::span<const std::byte> bytes) {
  datagram(Direction::kOut, own_, region, bytes);
}

void CaptureWriter::on_send(HostTime now, RegionId region, std::span<const std::byte> bytes) {
  now_ = now;
  on_send(region, bytes);
}

void CaptureWriter::on_control(HostTime now, Duration host_minus_wall, std::string_view line) {
  input(now, "control " + std::to_string(host_minus_wall.count()) + " " + std::string(line));
}

void CaptureWriter::on_poses(HostTime now, Duration host_minus_wall, std::string_view datagram) {
  input(now, "poses " + std::to_string(host_minus_wall.count()) + " " + std::string(datagram));
}

void CaptureWriter::on_signed(std::span<const std::byte, replication::kSignature_bytes> signature) {
  input(now_, "signed " + keys::base64_of(keys::as_octets(signature)));
}

void CaptureWriter::on_os_clock(HostTime now, const std::optional<replication::OsClock>& clock) {
  input(now, clock
                 ? "os-clock " + std::to_string(clock->minus_host.count()) + " " + std::to_string(clock->error.count())
                 : std::string("os-clock"));
}

void CaptureWriter::input(HostTime now, std::string_view text) {
  now_ = now;
  packets_.packet(kInputs, now, Direction::kIn, bytes_of(text));
}

void CaptureWriter::datagram(Direction direction, const ip::udp::endpoint& from, RegionId region,
                             std::span<const std::byte> bytes) {
  const auto group = net::group_endpoint(groups_, region);
  if (!group) throw std::runtime_error(group.error().sentence);
  std::vector<std::byte> payload;
  if (framed(groups_)) {
    const auto header = net::region_header(region);
    payload.assign(header.begin(), header.end());
  }
  payload.insert(payload.end(), bytes.begin(), bytes.end());
  packets_.packet(kNetwork, now_, direction, encode({from, *group, payload}));
}

std::expected<CaptureReader, std::string> CaptureReader::open(std::span<const std::byte> file) {
  CaptureReader reader(file);
  const auto first = reader.packets_.next();
  if (!first) return std::unexpected(first.error());
  constexpr std::string_view kWord = "peer ";
  if (!*first || (*first)->link != LinkType::kUser0 || !text_of((*first)->bytes).starts_with(kWord)) {
    return std::unexpected("its first packet does not say what a peer is made of: this is no capture of peerd's");
  }
  auto setup = setup_from(text_of((*first)->bytes).substr(kWord.size()));
  if (!setup) return std::unexpected(setup.error());
  if (setup->datagrams == Setup::Datagrams::kSealed) {
    return std::unexpected(
        "its datagrams are sealed as they were on the network, and it has no inputs; peerd record --opened has both");
  }
  reader.setup_ = *std::move(setup);
  reader.begin_ = reader.last_ = (*first)->at;
  reader.count_ = 1;
  return reader;
}

std::expected<Event, std::string> CaptureReader::take_datagram(const PcapngPacket& packet) const {
  const auto udp = decode_udp_packet(packet.bytes);
  const auto number = udp ? net::group_number(setup_.groups, udp->to.address()) : std::nullopt;
  if (!number || udp->to.port() != setup_.groups.port) {
    return std::unexpected("it is no UDP datagram to one of the session's groups");
  }
  std::optional<RegionId> region = net::region_of_group(setup_.groups, *number);
  std::span<const std::byte> datagram = udp->payload;
  if (framed(setup_.groups)) {
    region = net::read_region_header(datagram);
    if (!region) return std::unexpected("it does not say its region");
    datagram = datagram.subspan(net::kRegionHeaderBytes);
  }
  if (!region) return std::unexpected("its group is of no region");
  if (packet.direction == Direction::kIn) return Event{packet.at, DatagramIn{*region, datagram}};
  if (packet.direction == Direction::kOut) return Event{packet.at, DatagramOut{*region, datagram}};
  return std::unexpected("it says neither that it came in nor that it went out");
}

std::expected<std::optional<Event>, std::string> CaptureReader::next() {
  const auto packet = packets_.next();
  if (!packet) return std::unexpected(packet.error());
  if (!*packet) return std::nullopt;
  const auto wrong = [&](const std::string& why) {
    return std::unexpected("packet " + std::to_string(count_) + ": " + why);
  };
  ++count_;  // packets count from 1, as in Wireshark
  if ((*packet)->at < last_) return wrong("its time is before that of the one before");
  last_ = (*packet)->at;
  if ((*packet)->link == LinkType::kRawIp) {
    auto event = take_datagram(**packet);
    if (!event) return wrong(event.error());
    return *event;
  }
  if ((*packet)->link == LinkType::kUser0) {
    if (auto what = input_from(text_of((*packet)->bytes))) return Event{(*packet)->at, *what};
  }
  return wrong("it is nothing that a peer can be told");
}

std::vector<Signed> signatures_in(std::span<const std::byte> file) {
  std::vector<Signed> all;
  auto reader = CaptureReader::open(file);
  while (reader) {
    const auto event = reader->next();
    if (!event || !*event) break;
    if (const auto* const by_peer = std::get_if<Signed>(&(*event)->what)) all.push_back(*by_peer);
  }
  return all;
}

}  // namespace peerd::record
