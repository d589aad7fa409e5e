#include "peerd/net/doctor/pair_message.hpp"

#include <algorithm>
#include <cassert>
#include <concepts>
#include <string_view>

namespace peerd::doctor {
namespace {

constexpr std::string_view kMagic = "peerd=\1";

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  void text(std::string_view text) {
    for (const char c : text) bytes_[at_++] = static_cast<std::byte>(c);
  }
  template <std::unsigned_integral Number>
  void number(Number number) {
    for (std::size_t i = 0; i < sizeof number; ++i)
      bytes_[at_++] = static_cast<std::byte>(std::uint64_t{number} >> (8 * i));
  }
  void heard(const Heard& heard) {
    number<std::uint8_t>(heard.any);
    number(heard.stream);
    number(heard.largest_bytes);
  }
  [[nodiscard]] std::size_t size() const { return at_; }

 private:
  std::vector<std::byte>& bytes_;
  std::size_t at_ = 0;
};

// Reads a datagram that is long enough.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, std::size_t at) : bytes_(bytes), at_(at) {}
  template <std::unsigned_integral Number>
  [[nodiscard]] Number number() {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) number |= std::to_integer<std::uint64_t>(bytes_[at_++]) << (8 * i);
    return static_cast<Number>(number);
  }
  [[nodiscard]] std::int64_t time() { return static_cast<std::int64_t>(number<std::uint64_t>()); }
  [[nodiscard]] Heard heard() {
    Heard heard;
    heard.any = number<std::uint8_t>() != 0;
    heard.stream = number<std::uint16_t>();
    heard.largest_bytes = number<std::uint16_t>();
    return heard;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_;
};

std::uint64_t bits_of(Duration duration) { return static_cast<std::uint64_t>(duration.count()); }

// The sum of two plausible times does not overflow.
bool is_plausible(std::int64_t time) { return time >= 0 && time < std::int64_t{1} << 62; }

bool is_plausible(const PairMessage& m) {
  return m.session != 0 && m.path <= Path::kMulticast && m.tcp <= TcpState::kNoAnswer && m.in_stream <= kStream &&
         m.unicast.stream <= kStream && m.multicast.stream <= kStream &&
         is_plausible(m.sent.time_since_epoch().count()) && is_plausible(m.echo_sent.time_since_epoch().count()) &&
         is_plausible(m.echo_held.count());
}

}  // namespace

std::vector<std::byte> encode(const PairMessage& m, std::size_t size_bytes) {
  assert(size_bytes >= kPairMessage_bytes);
  std::vector<std::byte> bytes(size_bytes);
  Writer out(bytes);
  out.text(kMagic);
  out.number(static_cast<std::uint8_t>(m.path));
  out.number(m.session);
  out.number(m.other);
  out.number(bits_of(m.sent.time_since_epoch()));
  out.number(bits_of(m.echo_sent.time_since_epoch()));
  out.number(bits_of(m.echo_held));
  out.number(m.in_stream);
  out.number(m.tcp_port);
  out.number(static_cast<std::uint8_t>(m.tcp));
  out.number<std::uint8_t>(m.complete);
  out.heard(m.unicast);
  out.heard(m.multicast);
  assert(out.size() == kPairMessage_bytes);
  return bytes;
}

std::optional<PairMessage> decode_pair_message(std::span<const std::byte> datagram) {
  const auto same = [](std::byte b, char c) { return b == static_cast<std::byte>(c); };
  if (datagram.size() < kPairMessage_bytes || !std::ranges::equal(datagram.first(kMagic.size()), kMagic, same))
    return std::nullopt;
  Reader in(datagram, kMagic.size());
  PairMessage m;
  m.path = static_cast<Path>(in.number<std::uint8_t>());
  m.session = in.number<std::uint64_t>();
  m.other = in.number<std::uint64_t>();
  m.sent = HostTime{Duration{in.time()}};
  m.echo_sent = HostTime{Duration{in.time()}};
  m.echo_held = Duration{in.time()};
  m.in_stream = in.number<std::uint16_t>();
  m.tcp_port = in.number<std::uint16_t>();
  m.tcp = static_cast<TcpState>(in.number<std::uint8_t>());
  m.complete = in.number<std::uint8_t>() != 0;
  m.unicast = in.heard();
  m.multicast = in.heard();
  if (!is_plausible(m)) return std::nullopt;
  return m;
}

}  // namespace peerd::doctor
