#include "peerd/lab/live/assemble.hpp"

#include <algorithm>
#include <cstdint>

namespace peerd {
namespace {

// A row of some log, or where a life begins or ends, in true time. What begins precedes rows of the same instant.
struct Instant {
  enum class Kind : std::uint8_t { kEnter, kRow, kEnd };
  HostTime at;
  Kind kind;
  std::size_t log, row;
};

std::vector<Instant> in_true_time(const std::vector<PeerLog>& logs) {
  using Kind = Instant::Kind;
  std::vector<Instant> instants;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const std::vector<PeerLog::ObjectSample>& rows = logs[l].object_samples;
    instants.push_back({rows.empty() ? HostTime::min() : rows.front().true_at, Kind::kEnter, l, 0});
    for (std::size_t r = 0; r < rows.size(); ++r) instants.push_back({rows[r].true_at, Kind::kRow, l, r});
    if (logs[l].ended_at) instants.push_back({*logs[l].ended_at, Kind::kEnd, l, 0});
  }
  std::ranges::stable_sort(instants, {}, [](const Instant& i) { return std::pair(i.at, i.kind); });
  return instants;
}

}  // namespace

Result<measure::RunRecord> assemble(const config::RunSettings& run, const SharedWorld& shared,
                                    const std::vector<PeerLog>& logs, Measuring measuring) {
  auto made = RunAssembler::make(run, shared, std::move(measuring));
  if (!made) return std::unexpected(made.error());
  RunAssembler& assembler = **made;
  for (const Instant& i : in_true_time(logs)) {
    const PeerLog& log = logs[i.log];
    if (i.kind == Instant::Kind::kEnter) assembler.enter(log);
    if (i.kind == Instant::Kind::kRow) assembler.add(log, log.object_samples[i.row]);
    if (i.kind == Instant::Kind::kEnd) assembler.end(log.peer, *log.ended_at);
  }
  for (const PeerLog& log : logs) {
    for (const PeerLog::Update& update : log.updates) assembler.add(log, update);
    for (const PeerLog::Datagram& datagram : log.datagrams) assembler.add(log, datagram);
  }
  return assembler.finish(logs);
}

}  // namespace peerd
