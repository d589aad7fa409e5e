#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace peerd::bench {

// How fast datagrams are taken in and made, round by round, of the thread's own time.
struct CodecRates {
  std::vector<double> datagrams_per_s, records_per_s;
  std::vector<double> rounded_per_s;  // of encoding: records, the rounding included
  double record_bytes = 0.0;          // .. the mean
  std::vector<std::string> wrong;     // why the figures prove nothing; empty if they do
};

enum class Sealing : std::uint8_t { kNone, kSealed, kSigned };

// Datagrams of `batch` updates each, of `objects` that all have had an update, through Peer::on_packet, which are
// opened first where they are sealed; ticks run between rounds, untimed. In the end every ghost must be what its last
// update says.
[[nodiscard]] CodecRates decode_and_apply(std::size_t objects, std::size_t batch, bool quick, Sealing sealing);

// Batches of forty records of `objects`, each of which must be decoded as it was encoded.
[[nodiscard]] CodecRates encode_batches(std::size_t objects, bool quick);

}  // namespace peerd::bench
