#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "peerd/measure/run_record.hpp"

namespace peerd::report {

// What became of one row of RunRecord::contacts when the peers' rows were laid side by side (README: "Contacts").
enum class Verdict : std::uint8_t {
  kOutcome,    // a physical outcome: kind owner or decided
  kRepeated,   // the same outcome once more
  kAgreed,     // a peer's last word on another peer's outcome, same side
  kDisagreed,  // the same, other side
  kRevised,    // an earlier word, replaced by a later one of that peer
  kSpurious,   // predicted or applied, and there is no such outcome
  kOwn,        // a prediction about an outcome that this very peer decided
};
[[nodiscard]] std::string_view to_string(Verdict v);

// decided outcomes; agreed + disagreed + missed = decided x (peers - 1), unless several peers author one outcome.
struct Agreement {
  std::uint64_t decided = 0;
  std::uint64_t agreed = 0;
  std::uint64_t disagreed = 0;
  std::uint64_t missed = 0;
  std::uint64_t spurious = 0;
  std::uint64_t revised = 0;
  // Of collisions between objects of two peers alone (kind decided), not by words but by what a peer has taken over:
  // decided x (peers - 1) = agreed + disagreed + missed here too. One that is taken over and nobody's is spurious.
  struct Shared {
    std::uint64_t decided = 0, agreed = 0, disagreed = 0, missed = 0, spurious = 0;
  };
  Shared shared;
  std::vector<double> latency_s;  // one per agreed or disagreed word: from its contact time to when the peer held it
  std::vector<Verdict> verdicts;  // of RunRecord::contacts, by index
};

[[nodiscard]] Agreement agreement(const RunRecord& run);

}  // namespace peerd::report
