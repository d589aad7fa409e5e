#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/report/figure_json.hpp"

namespace peerd::report {

// The record of an object by its path; null if the run has none.
[[nodiscard]] const measure::ObjectInfo* find_object(const measure::RunRecord& run, std::string_view path);

// The peers other than the owner that have samples of the object, in the record's order.
[[nodiscard]] std::vector<measure::PeerInfo> observers_of(const measure::RunRecord& run,
                                                          const measure::ObjectInfo& object);

// A place at a time, and of a ghost its distance from the truth. They are no numbers where nobody had a sample for a
// long time: a line across would say that somebody did.
struct PathPoint {
  double t_s = 0.0;
  Vec3 position = Vec3::Zero();
  double error_m = 0.0;
};
// The truth of an object at all instants at which any peer has a sample of it. Not every peer receives an object all
// the time.
[[nodiscard]] std::vector<PathPoint> truth_of(const measure::RunRecord& run, const measure::ObjectInfo& object);
[[nodiscard]] std::vector<PathPoint> ghost_of(const measure::RunRecord& run, PeerId observer, ObjectId object);

// The length of an output bin: a second, as in the thesis, or a rounder number of seconds where a run is so long that
// bars of a second would be hairlines.
[[nodiscard]] double output_bin_s(double duration_s);
// The output of a peer in each bin [kB/s, kB = 1000 bytes]. The last bin may be shorter and is divided by its own
// length.
[[nodiscard]] std::vector<double> output_rates(const measure::RunRecord& run, PeerId sender);

}  // namespace peerd::report
