#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::measure {

// The judgement of one row of RunRecord::contacts after the peers' rows were laid side by side
// (docs/reference/measures.md, "Contacts").
enum class Verdict : std::uint8_t {
  kOutcome,    // physical outcome: kind owner or decided
  kRepeated,   // same outcome once more
  kAgreed,     // last statement of a peer on another peer's outcome, same side
  kDisagreed,  // last statement of a peer on another peer's outcome, other side
  kRevised,    // earlier statement, replaced by a later one of that peer
  kSpurious,   // predicted or applied, without such an outcome
  kOwn,        // prediction about an outcome that the same peer decided
};
[[nodiscard]] std::string_view to_string(Verdict v);

// The counts of a run. agreed + disagreed + missed = decided x (peers - 1), unless several peers author one outcome.
struct Agreement {
  std::uint64_t decided = 0;
  std::uint64_t agreed = 0;
  std::uint64_t disagreed = 0;
  std::uint64_t missed = 0;
  std::uint64_t spurious = 0;
  std::uint64_t revised = 0;
  // Collisions between objects of two peers alone (kind decided), judged not by statements but by the decisions that a
  // peer has applied. Here too agreed + disagreed + missed = decided x (peers - 1). A decision that is applied and that
  // no peer has stated is spurious.
  struct Shared {
    std::uint64_t decided = 0, agreed = 0, disagreed = 0, missed = 0, spurious = 0;
  };
  Shared shared;
  std::vector<double>
      latency_s;  // from contact time to when the peer held it; one for each agreed or disagreed statement
  std::vector<Verdict> verdicts;  // one for each row of RunRecord::contacts
};

[[nodiscard]] Agreement agreement(const RunRecord& run);

}  // namespace peerd::measure
