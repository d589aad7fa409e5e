#include "peerd/lab/measure/measured.hpp"

#include <algorithm>
#include <tuple>

namespace peerd::measure {

const ViewMeasured* Measured::view(PeerId observer, ObjectId object) const {
  const auto key = [](const ViewMeasured& v) { return std::tuple(v.observer, v.object); };
  const auto found = std::ranges::lower_bound(views, std::tuple(observer, object), {}, key);
  return found != views.end() && key(*found) == std::tuple(observer, object) ? &*found : nullptr;
}

std::uint64_t Measured::samples() const {
  std::uint64_t all = 0;
  for (const ViewMeasured& v : views) all += v.ghost_error_m.count + v.not_finite;
  return all;
}

std::uint64_t Measured::updates_sent() const {
  std::uint64_t all = 0;
  for (const auto& [object, totals] : updates) all += totals.updates;
  return all;
}

}  // namespace peerd::measure
