#include "peerd/lab/cluster/chaos_bytes.hpp"

#include "peerd/lab/cluster/bytes.hpp"

namespace peerd::cluster {

// A new field, or another order, is another kChaosFormat. The structured binding does not compile where a field is
// missing.
template <class A>
void fields(A& a, typename A::template Of<chaos::ChaosReport>& s) {
  auto& [seed, violations, trace_hash, peers, lives, faults, edits, operations, held, datagrams, damaged,
         one_world_after_s, branches] = s;
  a(seed, violations, trace_hash, peers, lives, faults, edits, operations, held, datagrams, damaged, one_world_after_s,
    branches);
}

std::string to_bytes(const chaos::ChaosReport& report) {
  ByteWriter writer;
  writer(kChaosFormat, report);
  return writer.take();
}

std::expected<chaos::ChaosReport, std::string> chaos_report_from(std::string_view bytes) {
  return read_result<chaos::ChaosReport>(bytes, kChaosFormat, "seed",
                                         [](ByteReader& reader, chaos::ChaosReport& report) { reader(report); });
}

}  // namespace peerd::cluster
