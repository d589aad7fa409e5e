#include "replication/wire/envelope.hpp"

#include <cstdint>

namespace peerd::replication {
namespace {

// Fields of a Datagram.
constexpr std::uint64_t kVersion = 1, kSender = 2, kNumber = 3, kIncarnation = 4, kRecords = 8;

// Takes what fields of Protobuf are made of from the front of bytes; each answers whether it is there.
bool take_number(std::span<const std::byte>& in, std::uint64_t& number) {
  number = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    if (in.empty()) return false;
    const auto group = std::to_integer<std::uint64_t>(in.front());
    in = in.subspan(1);
    number |= (group & 127) << shift;
    if (group < 128) return true;
  }
  return false;
}
bool skip(std::span<const std::byte>& in, std::uint64_t bytes) {
  if (bytes > in.size()) return false;
  in = in.subspan(static_cast<std::size_t>(bytes));
  return true;
}
// `number`: of a field that is a varint, else without a meaning.
bool take_value(std::span<const std::byte>& in, std::uint64_t type, std::uint64_t& number) {
  switch (type) {
    case 0:
      return take_number(in, number);
    case 1:
      return skip(in, 8);
    case 2:
      return take_number(in, number) && skip(in, number);
    case 5:
      return skip(in, 4);
    default:
      return false;
  }
}

}  // namespace

std::optional<Envelope> envelope_of(std::span<const std::byte> datagram) {
  std::optional<std::uint64_t> sender;
  Envelope envelope;
  envelope.has_only_updates = true;
  while (!datagram.empty()) {
    std::uint64_t tag = 0, number = 0;
    if (!take_number(datagram, tag)) return std::nullopt;
    const std::uint64_t field = tag >> 3, type = tag & 7;
    if (!take_value(datagram, type, number)) return std::nullopt;
    if (field == kSender) {
      if (sender || type != 0) return std::nullopt;
      sender = number;
    }
    envelope.has_only_updates = envelope.has_only_updates && (field == kVersion || field == kSender ||
                                                              field == kNumber || field == kIncarnation ||
                                                              field == kRecords);
  }
  if (!sender || *sender > UINT32_MAX) return std::nullopt;
  envelope.sender = PeerId{static_cast<std::uint32_t>(*sender)};
  return envelope;
}

}  // namespace peerd::replication
