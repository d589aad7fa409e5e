#include "replication/wire/envelope.hpp"

#include <array>
#include <cstdint>

namespace peerd::replication {
namespace {

// Fields of a Datagram, of its Hello, and of the Introduction in that.
constexpr std::uint64_t kVersion = 1, kSender = 2, kNumber = 3, kIncarnation = 4, kHello = 5, kDecisions = 6;
constexpr std::uint64_t kRecords = 8, kHandovers = 11, kScene = 13, kGhostDigest = 18;
constexpr std::uint64_t kIntroduction = 6, kOwned = 4;

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
struct Field {
  std::uint64_t field = 0, type = 0;
  std::uint64_t number = 0;          // of a varint
  std::span<const std::byte> bytes;  // of what has a length
};
bool take_field(std::span<const std::byte>& in, Field& field) {
  std::uint64_t tag = 0;
  if (!take_number(in, tag)) return false;
  field = {tag >> 3, tag & 7, 0, {}};
  switch (field.type) {
    case 0:
      return take_number(in, field.number);
    case 1:
      return skip(in, 8);
    case 2: {
      if (!take_number(in, field.number)) return false;
      const auto behind = in;
      if (!skip(in, field.number)) return false;
      field.bytes = behind.first(static_cast<std::size_t>(field.number));
      return true;
    }
    case 5:
      return skip(in, 4);
    default:
      return false;
  }
}

// Whether that field of a message, or one in it, and so on, has bytes.
bool has_bytes(std::span<const std::byte> message, std::span<const std::uint64_t> path) {
  Field field;
  while (!message.empty() && take_field(message, field)) {
    if (field.field != path.front() || field.bytes.empty()) continue;
    if (path.size() == 1 || has_bytes(field.bytes, path.subspan(1))) return true;
  }
  return false;
}

}  // namespace

std::optional<Envelope> envelope_of(std::span<const std::byte> datagram) {
  constexpr std::array kClaims{kIntroduction, kOwned};
  std::optional<std::uint64_t> sender;
  Envelope envelope;
  envelope.has_only_updates = true;
  Field field;
  while (!datagram.empty()) {
    if (!take_field(datagram, field)) return std::nullopt;
    switch (field.field) {
      case kSender:
        if (sender || field.type != 0) return std::nullopt;
        sender = field.number;
        break;
      case kVersion:
      case kNumber:
      case kIncarnation:
      case kGhostDigest:  // a false one costs its receivers a question
        break;
      case kRecords:
        envelope.changes_world = true;
        break;
      case kHello:
        envelope.has_only_updates = false;
        envelope.changes_world = envelope.changes_world || has_bytes(field.bytes, kClaims);
        break;
      case kDecisions:
      case kHandovers:
      case kScene:
        envelope.has_only_updates = false;
        envelope.changes_world = true;
        break;
      default:
        envelope.has_only_updates = false;
    }
  }
  if (!sender || *sender > UINT32_MAX) return std::nullopt;
  envelope.sender = PeerId{static_cast<std::uint32_t>(*sender)};
  return envelope;
}

}  // namespace peerd::replication
