#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "core/ids.hpp"
#include "peerd/statistics/statistics.hpp"

namespace peerd::report {

struct UpdateTotals {
  std::uint64_t updates = 0;
  std::uint64_t bytes = 0;
};

// The errors of one observer's ghost of one object.
struct ViewMeasured {
  PeerId observer;
  ObjectId object;
  std::uint64_t not_finite = 0;  // samples whose error is no number, which the statistics leave out
  Statistics ghost_error_m, shown_error_m, view_difference_m;
  double inconsistency_m_s = 0.0;  // time integral of the ghost error
};

// What is measured of a run, or of a part of it, of which not every row is kept.
struct Measured {
  double from_s = 0.0, until_s = 0.0;        // the part; both ends belong to it
  std::vector<ViewMeasured> views;           // those with samples, sorted by (observer, object)
  std::map<ObjectId, UpdateTotals> updates;  // of objects that were updated
  std::uint64_t datagrams = 0;
  std::uint64_t datagram_bytes = 0;

  // Null where the observer has no sample of the object.
  [[nodiscard]] const ViewMeasured* view(PeerId observer, ObjectId object) const;
  [[nodiscard]] std::uint64_t samples() const;  // of all views
  [[nodiscard]] std::uint64_t updates_sent() const;
};

}  // namespace peerd::report
