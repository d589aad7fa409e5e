#include "peerd/lab/measure/wrong_outcomes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "peerd/lab/measure/lookup.hpp"

namespace peerd::measure {
namespace {

bool same_pair(const ContactRow& a, const ContactRow& b) {
  return std::minmax(a.collider, a.collidee) == std::minmax(b.collider, b.collidee);
}

std::vector<const ContactRow*> decided(const RunRecord& run) {
  std::vector<const ContactRow*> rows;
  for (const ContactRow& row : run.contacts) {
    if (row.kind == "decided") rows.push_back(&row);
  }
  std::ranges::stable_sort(rows, {}, [](const ContactRow* r) { return r->t_s; });
  return rows;
}

}  // namespace

WrongOutcomes wrong_outcomes(const RunRecord& run, const RunRecord& truth) {
  std::vector<const ContactRow*> decisions = decided(run);
  const std::vector<const ContactRow*> happened = decided(truth);
  WrongOutcomes wrong{happened.size(), 0, 0};
  for (const ContactRow* true_row : happened) {
    const auto right = std::ranges::find_if(decisions, [&](const ContactRow* row) {
      return same_pair(*row, *true_row) && same_side(*row, *true_row) &&
             std::abs(row->t_s - true_row->t_s) <= kSameTime_s;
    });
    if (right == decisions.end()) {
      ++wrong.missing;
    } else {
      decisions.erase(right);
    }
  }
  wrong.spurious = decisions.size();
  return wrong;
}

}  // namespace peerd::measure
