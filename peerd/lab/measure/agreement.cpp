#include "peerd/lab/measure/agreement.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "peerd/lab/measure/lookup.hpp"

namespace peerd::measure {
namespace {

// Contacts are compared as contacts of an unordered pair.
using Pair = std::pair<ObjectId, ObjectId>;

Pair pair_of(const ContactRow& row) { return std::minmax(row.collider, row.collidee); }

struct Outcome {
  double t_s = 0.0;
  std::size_t row = 0;          // index of the first row that states it
  std::vector<PeerId> authors;  // more than one only where two peers state the same contact
};

bool has_author(const Outcome& o, PeerId peer) { return std::ranges::find(o.authors, peer) != o.authors.end(); }

// The outcomes of one pair, in order of time.
struct PairOutcomes {
  std::vector<Outcome> outcomes;
  double window_s = 0.0;
};

using OutcomesByPair = std::map<Pair, PairOutcomes>;

OutcomesByPair collect_outcomes(const RunRecord& run, Agreement& result) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    if (is_outcome(run.contacts[i])) rows.push_back(i);
  }
  std::ranges::stable_sort(rows, {}, [&](std::size_t i) { return run.contacts[i].t_s; });

  OutcomesByPair by_pair;
  for (const std::size_t i : rows) {
    const ContactRow& row = run.contacts[i];
    std::vector<Outcome>& outcomes = by_pair[pair_of(row)].outcomes;
    if (!outcomes.empty() && outcomes.back().t_s == row.t_s) {
      if (!has_author(outcomes.back(), row.peer)) outcomes.back().authors.push_back(row.peer);
      result.verdicts[i] = Verdict::kRepeated;
    } else {
      outcomes.push_back({row.t_s, i, {row.peer}});
      result.verdicts[i] = Verdict::kOutcome;
      ++result.decided;
    }
  }
  return by_pair;
}

// Half the shortest time between two outcomes of the pair by one author. With it no statement can lie in two windows,
// and none is dropped while it is nearer to an outcome than the next outcome could be. A pair that met once has no such
// gap; then the time to the nearest other outcome of its collider is used (one object cannot be in two contacts'
// places), and without one, half the run.
double window_s(const RunRecord& run, const OutcomesByPair& by_pair, const PairOutcomes& pair) {
  double gap_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < pair.outcomes.size(); ++i) {
    if (pair.outcomes[i].authors == pair.outcomes[i - 1].authors) {
      gap_s = std::min(gap_s, pair.outcomes[i].t_s - pair.outcomes[i - 1].t_s);
    }
  }
  if (std::isfinite(gap_s)) return 0.5 * gap_s;

  const Outcome& only = pair.outcomes.front();
  const ObjectId collider = run.contacts[only.row].collider;
  for (const auto& [key, other] : by_pair) {
    if (key.first != collider && key.second != collider) continue;
    for (const Outcome& o : other.outcomes) {
      const double away_s = std::abs(o.t_s - only.t_s);
      if (away_s > 0.0 && o.authors == only.authors) gap_s = std::min(gap_s, away_s);  // 0: two walls at a corner
    }
  }
  return 0.5 * std::min(gap_s, run.duration_s);
}

// The outcome nearest in time, the earlier one at a tie. Null means that it lies outside of its window.
const Outcome* nearest_outcome(const PairOutcomes& pair, double t_s) {
  const auto after = std::ranges::lower_bound(pair.outcomes, t_s, {}, &Outcome::t_s);
  const Outcome* best = nullptr;
  double best_s = pair.window_s;
  if (after != pair.outcomes.begin() && t_s - std::prev(after)->t_s <= best_s) {
    best = &*std::prev(after);
    best_s = t_s - best->t_s;
  }
  const bool closer = after != pair.outcomes.end() && (best ? after->t_s - t_s < best_s : after->t_s - t_s <= best_s);
  return closer ? &*after : best;
}

// Judges one peer's statements on one outcome, given as row indices. The last statement counts, and none comes after
// applying the very decision: a later prediction is about another contact. The statement has been held since the first
// of the unbroken run of equal statements at the end: to repeat it is no delay.
void judge_statements(const RunRecord& run, const Outcome& outcome, std::vector<std::size_t> statements,
                      Agreement& result) {
  const ContactRow& truth = run.contacts[outcome.row];
  const auto applied = [&](const ContactRow& row) { return row.kind == "applied" && row.t_s == truth.t_s; };
  std::ranges::sort(statements, {}, [&](std::size_t i) {
    const ContactRow& row = run.contacts[i];
    return std::tuple(applied(row), row.reported_at_s, row.kind == "applied", row.t_s, i);
  });
  const bool agrees = same_side(truth, run.contacts[statements.back()]);
  std::size_t held = statements.size() - 1;
  while (held > 0 && same_side(truth, run.contacts[statements[held - 1]]) == agrees) --held;

  const ContactRow& first = run.contacts[statements[held]];
  result.latency_s.push_back(first.reported_at_s - first.t_s);
  ++(agrees ? result.agreed : result.disagreed);
  result.revised += statements.size() - 1;
  for (const std::size_t i : statements) result.verdicts[i] = Verdict::kRevised;
  result.verdicts[statements.back()] = agrees ? Verdict::kAgreed : Verdict::kDisagreed;
}

// The last row of exactly that contact says what a peer has made of, or applied from, one decision.
Agreement::Shared compare_shared(const RunRecord& run) {
  struct Decision {
    const ContactRow* stated = nullptr;           // row of the first peer that decided it
    std::map<PeerId, const ContactRow*> applied;  // last row of each other peer
  };
  std::map<std::pair<Pair, double>, Decision> decisions;
  for (const ContactRow& row : run.contacts) {
    if (row.kind != "decided" && row.kind != "applied") continue;
    Decision& decision = decisions[{pair_of(row), row.t_s}];
    decision.applied[row.peer] = &row;
    if (row.kind == "decided" && decision.stated == nullptr) decision.stated = &row;
  }
  Agreement::Shared shared;
  for (const auto& [contact, decision] : decisions) {
    if (decision.stated == nullptr) {
      shared.spurious += decision.applied.size();
      continue;
    }
    ++shared.decided;
    for (const PeerInfo& peer : run.peers) {
      if (peer.peer == decision.stated->peer) continue;
      const auto held = decision.applied.find(peer.peer);
      if (held == decision.applied.end()) {
        shared.missed += was_present(peer, decision.stated->t_s) ? 1 : 0;
      } else {
        ++(same_side(*decision.stated, *held->second) ? shared.agreed : shared.disagreed);
      }
    }
  }
  return shared;
}

}  // namespace

std::string_view to_string(Verdict v) {
  switch (v) {
    case Verdict::kOutcome:
      return "outcome";
    case Verdict::kRepeated:
      return "repeated";
    case Verdict::kAgreed:
      return "agreed";
    case Verdict::kDisagreed:
      return "disagreed";
    case Verdict::kRevised:
      return "revised";
    case Verdict::kSpurious:
      return "spurious";
    case Verdict::kOwn:
      return "own";
  }
  assert(false);
  return "";
}

Agreement agreement(const RunRecord& run) {
  Agreement result;
  result.shared = compare_shared(run);
  result.verdicts.resize(run.contacts.size(), Verdict::kOwn);
  OutcomesByPair by_pair = collect_outcomes(run, result);
  for (auto& [key, pair] : by_pair) pair.window_s = window_s(run, by_pair, pair);

  std::map<std::pair<const Outcome*, PeerId>, std::vector<std::size_t>>
      statements;  // for lookup alone; the order is never used
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const ContactRow& row = run.contacts[i];
    if (is_outcome(row)) continue;
    const auto pair = by_pair.find(pair_of(row));
    const Outcome* outcome = pair != by_pair.end() ? nearest_outcome(pair->second, row.t_s) : nullptr;
    if (outcome == nullptr) {
      result.verdicts[i] = Verdict::kSpurious;
      ++result.spurious;
    } else if (!has_author(*outcome, row.peer)) {
      statements[{outcome, row.peer}].push_back(i);
    }
  }
  for (const auto& [key, pair] : by_pair) {
    for (const Outcome& outcome : pair.outcomes) {
      for (const PeerInfo& peer : run.peers) {
        if (has_author(outcome, peer.peer)) continue;
        const auto stated = statements.find({&outcome, peer.peer});
        if (stated == statements.end()) {
          result.missed += was_present(peer, outcome.t_s) ? 1 : 0;
        } else {
          judge_statements(run, outcome, stated->second, result);
        }
      }
    }
  }
  return result;
}

}  // namespace peerd::measure
