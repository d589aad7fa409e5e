#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "core/ids.hpp"
#include "peerd/lab/measure/statistics/statistics.hpp"

namespace peerd::measure {

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
  // The samples of an object that has stood still for kRestsAfter_s and goes on to do so for kRestsFor_s, and the
  // largest ghost error of those.
  std::uint64_t rest_samples = 0;
  double rest_error_max_m = 0.0;
};

// An object that has stood still for so long is at rest: whatever its receivers had to know has come, but for long
// losses. What moves it next may be known elsewhere before its owner knows it, so that the last moments do not count.
inline constexpr double kRestsAfter_s = 2.0, kRestsFor_s = 1.0;

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

}  // namespace peerd::measure
