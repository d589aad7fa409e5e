#include "peerd/net/discovery/beacon.hpp"

#include <algorithm>
#include <cassert>
#include <concepts>
#include <string_view>

#include "peerd/input/printable.hpp"

namespace peerd::discovery {
namespace {

// The question and the beacon begin with a word and the version of their format.
constexpr std::string_view kQuestionMagic = "peerd?\1";
constexpr std::string_view kBeaconMagic = "peerd!\2";

std::vector<std::byte> bytes_of(std::string_view text) {
  std::vector<std::byte> bytes(text.size());
  std::ranges::transform(text, bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

bool starts_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() &&
         std::ranges::equal(bytes.first(text.size()), text, {}, [](std::byte b) { return static_cast<char>(b); });
}

// The least significant byte first.
template <std::unsigned_integral Number>
void write(std::vector<std::byte>& out, Number number) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) out.push_back(static_cast<std::byte>(number >> (8 * i)));
}

void write(std::vector<std::byte>& out, std::string_view name) {
  const auto bytes = bytes_of(printable(name, kNameMax_bytes));
  write(out, static_cast<std::uint8_t>(bytes.size()));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// Takes numbers and names from the front of a datagram that is long enough for them.
class Reading {
 public:
  explicit Reading(std::span<const std::byte> rest) : rest_(rest) {}

  template <std::unsigned_integral Number>
  [[nodiscard]] Number number() {
    const auto bytes = take(sizeof(Number));
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) number |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
    return static_cast<Number>(number);
  }
  [[nodiscard]] std::string name() {
    const auto bytes = take(number<std::uint8_t>());
    std::string name(bytes.size(), ' ');
    std::ranges::transform(bytes, name.begin(), [](std::byte b) { return static_cast<char>(b); });
    return printable(name, kNameMax_bytes);
  }
  [[nodiscard]] bool is_whole() const { return !is_short_ && rest_.empty(); }

 private:
  std::span<const std::byte> take(std::size_t size) {
    if (size > rest_.size()) {
      is_short_ = true;
      return {};
    }
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }

  std::span<const std::byte> rest_;
  bool is_short_ = false;
};

}  // namespace

std::vector<std::byte> question() {
  std::vector<std::byte> datagram = bytes_of(kQuestionMagic);
  datagram.resize(kQuestion_bytes);
  return datagram;
}

bool is_question(std::span<const std::byte> datagram) {
  return datagram.size() >= kQuestion_bytes && starts_with(datagram, kQuestionMagic);
}

std::vector<std::byte> encode(const Beacon& beacon) {
  std::vector<std::byte> datagram = bytes_of(kBeaconMagic);
  write(datagram, beacon.protocol);
  write(datagram, beacon.session);
  write(datagram, beacon.peer.value);
  write(datagram, beacon.incarnation);
  write(datagram, beacon.snapshot_port);
  write(datagram, beacon.world);
  write(datagram, beacon.name);
  write(datagram, static_cast<std::uint8_t>(beacon.sealed));
  assert(datagram.size() <= kQuestion_bytes);
  return datagram;
}

std::optional<Beacon> decode(std::span<const std::byte> datagram) {
  if (!starts_with(datagram, kBeaconMagic)) return std::nullopt;
  Reading reading(datagram.subspan(kBeaconMagic.size()));
  Beacon beacon;
  beacon.protocol = reading.number<std::uint32_t>();
  beacon.session = reading.number<std::uint64_t>();
  beacon.peer = PeerId{reading.number<std::uint32_t>()};
  beacon.incarnation = reading.number<std::uint64_t>();
  beacon.snapshot_port = reading.number<std::uint16_t>();
  beacon.world = reading.name();
  beacon.name = reading.name();
  beacon.sealed = reading.number<std::uint8_t>() != 0;
  if (!reading.is_whole() || beacon.peer == kNobody) return std::nullopt;
  return beacon;
}

}  // namespace peerd::discovery
