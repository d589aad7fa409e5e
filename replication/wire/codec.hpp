#pragma once
#include <expected>
#include <memory>
#include <span>
#include <string_view>

#include "replication/wire/record.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::proto {
class Datagram;
}

namespace peerd::replication {

inline constexpr std::uint32_t kProtocolVersion = 12;
// The largest datagram. It is never fragmented: below every tunnel's MTU once a signature, a seal, UDP, IP and a link's
// headers are added.
inline constexpr std::size_t kDatagramMax_bytes = 1136;

// A peer's name: 1 to kNameMax_bytes visible ASCII characters without '/'. It goes into logs and file names; longer
// ones would push a hello's lists out of its datagram.
inline constexpr std::size_t kNameMax_bytes = 64;
[[nodiscard]] bool is_name(std::string_view text);

// The largest latency: peers that decide collisions together cannot wait for each other longer.
inline constexpr std::chrono::milliseconds kLatencyMax{2000};
// Peers publish their latencies in whole steps of this, one at least (latency_bound()).
inline constexpr std::chrono::milliseconds kLatencyStep{50};

// A peer whose time may be farther from its session's publishes none; sums of some such errors stay within int64 (36
// years).
inline constexpr Duration kClockErrorMax{std::int64_t{1} << 60};
// The largest error that Linux reports for a clock (NTP_PHASE_LIMIT).
inline constexpr std::chrono::seconds kOsErrorMax{16};

enum class DecodeError : std::uint8_t {
  kTooLong,       // more than kDatagramMax_bytes
  kNotADatagram,  // Protobuf can't parse it
  kVersion,       // another protocol version
  kSender,        // peer number 0
  kValue,         // a number that is not finite, out of its range, or no unit vector or quaternion
};

[[nodiscard]] const char* to_string(DecodeError);

// The bytes of a message. The caller keeps them within kDatagramMax_bytes (encoded_size_bytes helps).
[[nodiscard]] Bytes encode(const Message& message);

// The message of a datagram. Trusts nothing: every value that comes back is finite and in range, unit vectors and
// quaternions unit within 1e-6. Times of updates and decisions travel without the bits that all receivers know: they
// are taken to be within 9 minutes of `near`.
[[nodiscard]] std::expected<Message, DecodeError> decode(std::span<const std::byte> datagram, SimTime near);

// Encodes and decodes many messages, one after the other: the next one uses the memory of the last.
class Codec {
 public:
  Codec();
  ~Codec();
  // Encodes a message. `updates`, whose times count from the first one's, go in place of the message's own. The bytes
  // replace those of `datagram`, whose memory they use.
  void encode(const Message& message, std::span<const EncodedUpdate> updates, Bytes& datagram);
  // Decodes a datagram. The message is valid until the next call.
  [[nodiscard]] std::expected<Message*, DecodeError> decode(std::span<const std::byte> datagram, SimTime near);
  // The version and the sender of a datagram that was refused for its version: these two mean the same in all
  // versions.
  [[nodiscard]] std::uint32_t version() const;
  [[nodiscard]] PeerId sender() const;

 private:
  std::unique_ptr<proto::Datagram> datagram_;
  Message decoded_;
};

// The bytes that one record adds to a datagram, for an update behind others of which the first is of the time `first`.
// The first update of a datagram adds kUpdatesHeader_bytes besides: the base time, and the length of all updates.
[[nodiscard]] std::size_t encoded_size_bytes(const UpdateRecord& record, SimTime first);
inline constexpr std::size_t kUpdatesHeader_bytes = 8;
// The bytes that the first state of a scene object adds besides its record, whose times count from its own.
inline constexpr std::size_t kSceneHeader_bytes = 20;
// The bytes that a decision adds; the first one adds kDecisionsHeader_bytes besides.
[[nodiscard]] std::size_t encoded_size_bytes(const DecisionRecord& record);
inline constexpr std::size_t kDecisionsHeader_bytes = 3;

}  // namespace peerd::replication
