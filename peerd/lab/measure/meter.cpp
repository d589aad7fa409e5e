#include "peerd/lab/measure/meter.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "peerd/lab/measure/lookup.hpp"

namespace peerd::measure {
namespace {

// Squares of errors up to this one add up without overflow, and no scene is as large: a larger error comes from a
// division by zero.
constexpr double kGreatestError_m = 1e100;

// More samples than a view can have: a clock that is corrected may take one twice.
std::uint64_t most_samples(double duration_s, double sample_hz) {
  return static_cast<std::uint64_t>(1.1 * duration_s * sample_hz) + 100;
}

}  // namespace

void ViewMeter::add(const GhostSample& sample) {
  ++count_;
  const double ghost_m = ghost_error_m(sample), shown_m = shown_error_m(sample);
  const double difference_m = view_difference_m(sample);
  if (!(ghost_m < kGreatestError_m) || !(shown_m < kGreatestError_m) || !(difference_m < kGreatestError_m)) {
    ++not_finite_;
    return;
  }
  const bool first = count_ == not_finite_ + 1;
  // Session time may step back: then the time until the last sample is in the integral already.
  if (first || sample.t_s >= last_s_) {
    if (!first) integral_m_s_ += (sample.t_s - last_s_) * 0.5 * (ghost_m + last_m_);
    last_s_ = sample.t_s;
    last_m_ = ghost_m;
  }
  ghost_m_.add(ghost_m);
  shown_m_.add(shown_m);
  difference_m_.add(difference_m);
  const bool stands =
      sample.truth.position == place_.position && sample.truth.orientation.coeffs() == place_.orientation.coeffs();
  if (first || !stands || sample.t_s < stands_since_s_) {
    place_ = sample.truth;
    stands_since_s_ = latest_since_s_ = sample.t_s;
    recent_ = latest_ = {};
  }
  if (sample.t_s - stands_since_s_ >= kRestsAfter_s) add_rest(sample.t_s, ghost_m);
}

void ViewMeter::add_rest(double t_s, double ghost_m) {
  if (t_s - latest_since_s_ >= kRestsFor_s) {
    rest_.add(recent_);
    recent_ = std::exchange(latest_, {});
    latest_since_s_ = t_s;
  }
  latest_.add({1, ghost_m});
}

void ViewMeter::Rest::add(const Rest& other) {
  samples += other.samples;
  error_max_m = std::max(error_max_m, other.error_max_m);
}

ViewMeasured ViewMeter::result(PeerId observer, ObjectId object) const {
  return {.observer = observer,
          .object = object,
          .not_finite = not_finite_,
          .ghost_error_m = ghost_m_.result(),
          .shown_error_m = shown_m_.result(),
          .view_difference_m = difference_m_.result(),
          .inconsistency_m_s = integral_m_s_,
          .rest_samples = rest_.samples,
          .rest_error_max_m = rest_.error_max_m};
}

RunMeter::RunMeter(double duration_s, double sample_hz, const RowLimits& limits, std::vector<TimeSpan> parts)
    : samples_(limits.samples), updates_(limits.updates), datagrams_(limits.datagrams) {
  parts.insert(parts.begin(), {0.0, duration_s});
  for (const TimeSpan& part : parts) {
    Part& added = parts_.emplace_back();
    added.measured.from_s = part.from_s;
    added.measured.until_s = part.until_s;
    added.most_samples = most_samples(duration_s, sample_hz);
  }
}

void RunMeter::add(GhostSample sample) {
  std::uint64_t ordinal = 0;
  for (Part& part : parts_) {
    if (sample.t_s < part.measured.from_s || sample.t_s > part.measured.until_s) continue;
    ViewMeter& view = part.views.try_emplace({sample.observer, sample.object}, part.most_samples).first->second;
    if (&part == &parts_.front()) ordinal = view.count();
    view.add(sample);
  }
  samples_.add(ordinal, std::move(sample));
}

void RunMeter::add(UpdateSent update) {
  std::uint64_t ordinal = 0;
  for (Part& part : parts_) {
    if (update.t_s < part.measured.from_s || update.t_s > part.measured.until_s) continue;
    UpdateTotals& totals = part.measured.updates[update.object];
    if (&part == &parts_.front()) ordinal = totals.updates;
    ++totals.updates;
    totals.bytes += update.bytes;
  }
  updates_.add(ordinal, std::move(update));
}

void RunMeter::add(const DatagramSent& datagram) {
  const std::uint64_t ordinal = parts_.front().measured.datagrams;
  for (Part& part : parts_) {
    if (datagram.t_s < part.measured.from_s || datagram.t_s > part.measured.until_s) continue;
    ++part.measured.datagrams;
    part.measured.datagram_bytes += datagram.bytes;
  }
  std::vector<std::uint64_t>& seconds = output_bytes_[datagram.sender];
  const auto second = static_cast<std::size_t>(datagram.t_s);
  if (seconds.size() <= second) seconds.resize(second + 1);
  seconds[second] += datagram.bytes;
  datagrams_.add(ordinal, datagram);
}

void RunMeter::finish(RunRecord& record, double until_s) {
  record.ghost_samples = samples_.take();
  std::ranges::stable_sort(record.ghost_samples, [](const auto& a, const auto& b) {
    return std::tie(a.observer, a.object, a.t_s) < std::tie(b.observer, b.object, b.t_s);
  });
  record.updates = updates_.take();
  std::ranges::stable_sort(record.updates, {}, [](const UpdateSent& u) { return std::tuple(u.t_s, u.sender); });
  record.datagrams = datagrams_.take();
  std::ranges::stable_sort(record.datagrams, {}, [](const DatagramSent& d) { return std::tuple(d.t_s, d.sender); });

  RunMeasured& measured = record.measured.emplace();
  measured.rows_complete = samples_.stride() == 1 && updates_.stride() == 1 && datagrams_.stride() == 1;
  for (Part& part : parts_) {
    for (const auto& [names, meter] : part.views) {
      part.measured.views.push_back(meter.result(names.first, names.second));
    }
    part.views.clear();
    part.measured.until_s = std::min(part.measured.until_s, until_s);
    measured.parts.push_back(std::move(part.measured));
  }
  measured.whole = std::move(measured.parts.front());
  measured.parts.erase(measured.parts.begin());
  measured.output_bytes = std::move(output_bytes_);
}

Measured measured_of(const RunRecord& run) { return *measured_of(run, {0.0, run.duration_s}); }

std::optional<Measured> measured_of(const RunRecord& run, const TimeSpan& part) {
  const bool whole = part.from_s == 0.0 && part.until_s == run.duration_s;
  if (run.measured) {
    if (whole) return run.measured->whole;
    const auto found = std::ranges::find_if(run.measured->parts, [&](const Measured& m) {
      return m.from_s == part.from_s && m.until_s == std::min(part.until_s, run.duration_s);
    });
    if (found != run.measured->parts.end()) return *found;
    if (!run.measured->rows_complete) return std::nullopt;
  }
  Measured measured{.from_s = part.from_s, .until_s = part.until_s, .views = {}, .updates = {}};
  const auto outside = [&](const auto& row) { return !whole && (row.t_s < part.from_s || row.t_s > part.until_s); };
  std::map<std::pair<PeerId, ObjectId>, ViewMeter> views;
  for (const GhostSample& s : run.ghost_samples) {
    if (!outside(s)) views.try_emplace({s.observer, s.object}, run.ghost_samples.size()).first->second.add(s);
  }
  for (const auto& [names, meter] : views) measured.views.push_back(meter.result(names.first, names.second));
  for (const UpdateSent& u : run.updates) {
    if (outside(u)) continue;
    UpdateTotals& totals = measured.updates[u.object];
    ++totals.updates;
    totals.bytes += u.bytes;
  }
  for (const DatagramSent& d : run.datagrams) {
    if (outside(d)) continue;
    ++measured.datagrams;
    measured.datagram_bytes += d.bytes;
  }
  return measured;
}

}  // namespace peerd::measure
