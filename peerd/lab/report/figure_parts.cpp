#include "peerd/lab/report/figure_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "peerd/lab/measure/lookup.hpp"

namespace peerd::report {
namespace {

std::vector<PathPoint> with_gaps(const std::vector<PathPoint>& path) {
  constexpr double kShortest_s = 0.25, kSteps = 8.0, kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<PathPoint> result;
  if (path.empty()) return result;
  const double step_s = (path.back().t_s - path.front().t_s) / static_cast<double>(path.size());
  const double gap_s = std::max(kShortest_s, kSteps * step_s);
  for (const PathPoint& p : path) {
    if (!result.empty() && p.t_s - result.back().t_s > gap_s) result.push_back({p.t_s, kNone * Vec3::Ones(), kNone});
    result.push_back(p);
  }
  return result;
}

}  // namespace

const measure::ObjectInfo* find_object(const measure::RunRecord& run, std::string_view path) {
  const auto it = std::ranges::find(run.objects, path, &measure::ObjectInfo::path);
  return it != run.objects.end() ? &*it : nullptr;
}

std::vector<measure::PeerInfo> observers_of(const measure::RunRecord& run, const measure::ObjectInfo& object) {
  std::vector<measure::PeerInfo> observers;
  for (const measure::PeerInfo& peer : run.peers) {
    if (peer.peer != object.owner && !measure::ghost_samples_of(run, peer.peer, object.object).empty())
      observers.push_back(peer);
  }
  return observers;
}

std::vector<PathPoint> truth_of(const measure::RunRecord& run, const measure::ObjectInfo& object) {
  std::vector<PathPoint> truth;
  for (const measure::PeerInfo& observer : run.peers) {
    for (const measure::GhostSample& s : measure::ghost_samples_of(run, observer.peer, object.object))
      truth.push_back({s.t_s, s.truth.position});
  }
  std::ranges::stable_sort(truth, {}, &PathPoint::t_s);
  const auto repeated = std::ranges::unique(truth, {}, &PathPoint::t_s);
  truth.erase(repeated.begin(), repeated.end());
  return with_gaps(truth);
}

std::vector<PathPoint> ghost_of(const measure::RunRecord& run, PeerId observer, ObjectId object) {
  std::vector<PathPoint> ghost;
  for (const measure::GhostSample& s : measure::ghost_samples_of(run, observer, object))
    ghost.push_back({s.t_s, s.ghost.position, measure::ghost_error_m(s)});
  return with_gaps(ghost);
}

double output_bin_s(double duration_s) {
  if (!(duration_s > 120.0)) return 1.0;
  for (double power_s = 1.0;; power_s *= 10.0) {
    for (const double width_s : {power_s, 2.0 * power_s, 5.0 * power_s}) {
      if (duration_s <= 120.0 * width_s) return width_s;
    }
  }
}

std::vector<double> output_rates(const measure::RunRecord& run, PeerId sender) {
  const double width_s = output_bin_s(run.duration_s);
  const auto count = static_cast<std::size_t>(std::ceil(run.duration_s / width_s));
  std::vector<double> rates(count, 0.0);
  if (count == 0) return rates;
  const auto add = [&](double t_s, double bytes) {
    rates[std::min(count - 1, static_cast<std::size_t>(t_s / width_s))] += bytes;
  };
  if (run.measured) {  // a bin is a whole number of seconds
    const auto found = run.measured->output_bytes.find(sender);
    const bool sent = found != run.measured->output_bytes.end();
    for (std::size_t second = 0; sent && second < found->second.size(); ++second) {
      add(static_cast<double>(second), static_cast<double>(found->second[second]));
    }
  } else {
    for (const measure::DatagramSent& d : run.datagrams) {
      if (d.sender == sender && d.t_s >= 0.0) add(d.t_s, d.bytes);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double begin_s = static_cast<double>(i) * width_s;
    rates[i] *= 1e-3 / std::min(width_s, run.duration_s - begin_s);
  }
  return rates;
}

}  // namespace peerd::report
