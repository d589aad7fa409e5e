#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/statistics/running_statistics.hpp"
#include "peerd/lab/measure/statistics/thinned.hpp"

namespace peerd::measure {

// How many rows a record keeps of each kind, for the pictures and the CSV files.
struct RowLimits {
  std::size_t samples = 500'000;
  std::size_t updates = 200'000;
  std::size_t datagrams = 200'000;
};

// A part of a run, with both ends.
struct TimeSpan {
  double from_s = 0.0, until_s = 0.0;
};

// Measures one observer's ghost of one object over one part of a run.
class ViewMeter {
 public:
  explicit ViewMeter(std::uint64_t most_samples)
      : ghost_m_(most_samples), shown_m_(most_samples), difference_m_(most_samples) {}

  void add(const GhostSample& sample);
  [[nodiscard]] ViewMeasured result(PeerId observer, ObjectId object) const;
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  RunningStatistics ghost_m_, shown_m_, difference_m_;
  std::uint64_t count_ = 0, not_finite_ = 0;
  double last_s_ = 0.0, last_m_ = 0.0;  // the latest sample with a number
  double integral_m_s_ = 0.0;
  Pose place_;  // of the truth, unchanged since stands_since_s_
  double stands_since_s_ = 0.0;
  struct Rest {
    std::uint64_t samples = 0;
    double error_max_m = 0.0;

    void add(const Rest& other);
  };
  void add_rest(double t_s, double ghost_m);
  Rest rest_;             // of what is known to have stood on
  Rest recent_, latest_;  // of the last kRestsFor_s to twice that long, and of what has come since
  double latest_since_s_ = 0.0;
};

// Measures a run while its rows come, and keeps as many of them as the limits allow. Its memory grows with the number
// of views and of objects, and hardly with the duration: RunningStatistics says how.
class RunMeter {
 public:
  // The samples of a view are at most `sample_hz` a second. `parts` are measured beside the whole run.
  RunMeter(double duration_s, double sample_hz, const RowLimits& limits, std::vector<TimeSpan> parts);

  // Samples of a view come in the order in which they were taken: their times go back where session time steps back.
  void add(GhostSample sample);
  void add(UpdateSent update);
  void add(const DatagramSent& datagram);

  // Moves what was kept and measured into the record. `until_s`: the end of the run, which may have been stopped.
  void finish(RunRecord& record, double until_s);

 private:
  struct Part {
    Measured measured;
    std::map<std::pair<PeerId, ObjectId>, ViewMeter> views;
    std::uint64_t most_samples;
  };

  std::vector<Part> parts_;  // the whole run first
  std::map<PeerId, std::vector<std::uint64_t>> output_bytes_;
  Thinned<GhostSample> samples_;
  Thinned<UpdateSent> updates_;
  Thinned<DatagramSent> datagrams_;
};

// The measures of a whole record, whether or not it keeps all rows.
[[nodiscard]] Measured measured_of(const RunRecord& run);

// The measures of a part of it; none where the record keeps only some rows and the part was not measured.
[[nodiscard]] std::optional<Measured> measured_of(const RunRecord& run, const TimeSpan& part);

}  // namespace peerd::measure
