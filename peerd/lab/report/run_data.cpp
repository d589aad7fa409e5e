#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/statistics/statistics.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

constexpr std::size_t kMostSenders = 6;      // number of colours that can be told apart
constexpr std::size_t kMostContacts = 3000;  // beside those of the principal object; more marks make a black bar

std::vector<Point> component_of(const std::vector<PathPoint>& path, int component) {
  std::vector<Point> points;
  for (const PathPoint& p : path) points.push_back({p.t_s, p.position[component]});
  return points;
}

// The range of the values, and of their distance from the straight line from the first to the last.
std::pair<double, double> range_and_bend(const std::vector<Point>& points) {
  Range range, bend;
  for (const Point& p : points) {
    const Point &a = points.front(), &b = points.back();
    range.add(p.y);
    bend.add(p.y - std::lerp(a.y, b.y, b.x > a.x ? (p.x - a.x) / (b.x - a.x) : 0.0));
  }
  return {range.width(), bend.width()};
}

// One observer's ghost of the object: a component of its position, its error, and the mean of all finite errors, of
// which the curve may have only some.
Json observer_data(const measure::RunRecord& run, const measure::PeerInfo& observer, ObjectId object,
                   const FigureChoice& choice) {
  const std::vector<PathPoint> ghost = ghost_of(run, observer.peer, object);
  std::vector<Point> error;
  std::vector<double> finite;
  for (const PathPoint& p : ghost) {
    error.push_back({p.t_s, p.error_m});
    if (std::isfinite(p.error_m)) finite.push_back(p.error_m);
  }
  const measure::ViewMeasured* const whole = run.measured ? run.measured->whole.view(observer.peer, object) : nullptr;
  return {{"name", observer.name},
          {"mean_m", whole != nullptr ? whole->ghost_error_m.mean : measure::statistics(std::move(finite)).mean},
          {"ghost", curve(thinned(component_of(ghost, choice.component), choice.buckets))},
          {"error", curve(thinned(error, choice.buckets))}};
}

// The updates of the object: how many there were, and those that the record has, with the thresholds in force.
Json updates_data(const measure::RunRecord& run, ObjectId object) {
  std::vector<double> times, thresholds;
  for (const measure::UpdateSent& u : run.updates) {
    if (u.object == object) (times.push_back(u.t_s), thresholds.push_back(u.threshold_m));
  }
  std::uint64_t count = times.size();
  if (run.measured) {
    const auto found = run.measured->whole.updates.find(object);
    count = found != run.measured->whole.updates.end() ? found->second.updates : 0;
  }
  return {{"count", count}, {"at", numbers(times)}, {"threshold_m", numbers(thresholds)}};
}

// What the peers send that send most, and the owner of the principal object.
Json output_data(const measure::RunRecord& run, const measure::ObjectInfo* object) {
  struct Sender {
    const measure::PeerInfo* peer;
    std::vector<double> rates;
    double sum;
  };
  std::vector<Sender> senders;
  for (const measure::PeerInfo& peer : run.peers) {
    std::vector<double> rates = output_rates(run, peer.peer);
    const double sum = std::accumulate(rates.begin(), rates.end(), 0.0);
    senders.push_back({&peer, std::move(rates), sum});
  }
  std::ranges::stable_sort(senders, std::ranges::greater{}, &Sender::sum);
  Json output = Json::array();
  for (std::size_t i = 0; i < senders.size(); ++i) {
    if (i >= kMostSenders && (object == nullptr || senders[i].peer->peer != object->owner)) continue;
    output.push_back({{"name", senders[i].peer->name}, {"kB_s", numbers(senders[i].rates)}});
  }
  return output;
}

// The kind of a statement about a contact, as the script counts them; none for a row that only repeats another.
std::optional<std::size_t> kind_of(const measure::ContactRow& contact, measure::Verdict verdict) {
  switch (verdict) {
    case measure::Verdict::kOutcome:
      return contact.kind == "decided" ? 1 : 0;
    case measure::Verdict::kAgreed:
      return contact.kind == "applied" ? 4 : 2;
    case measure::Verdict::kDisagreed:
    case measure::Verdict::kSpurious:
      return 3;
    case measure::Verdict::kRepeated:
    case measure::Verdict::kRevised:
    case measure::Verdict::kOwn:
      return std::nullopt;
  }
  return std::nullopt;
}

// The peers' statements about contacts, in columns: time, index of the peer, kind, when the peer knew it, and whether
// the principal object takes part. `counts` has all of each kind.
Json contacts_data(const measure::RunRecord& run, const measure::ObjectInfo* object) {
  const measure::Agreement judged = measure::agreement(run);
  std::vector<double> at, known;
  Json peers = Json::array(), kinds = Json::array(), own = Json::array();
  std::array<std::size_t, 5> counts{};
  std::size_t others = 0;
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const measure::ContactRow& c = run.contacts[i];
    const std::optional<std::size_t> kind = kind_of(c, judged.verdicts[i]);
    if (!kind || !drawable(c.t_s)) continue;
    ++counts[*kind];
    const bool takes_part = object != nullptr && (c.collider == object->object || c.collidee == object->object);
    if (!takes_part && ++others > kMostContacts) continue;
    at.push_back(c.t_s);
    known.push_back(std::clamp(c.reported_at_s, 0.0, run.duration_s));
    peers.push_back(std::ranges::find(run.peers, c.peer, &measure::PeerInfo::peer) - run.peers.begin());
    kinds.push_back(*kind);
    own.push_back(takes_part ? 1 : 0);
  }
  return {{"at", numbers(at)}, {"known", numbers(known)}, {"peer", peers}, {"kind", kinds},
          {"own", own},        {"counts", counts}};
}

}  // namespace

FigureChoice figure_choice(std::span<const measure::RunRecord> runs, const Json& summary) {
  constexpr std::size_t kAllRuns = 20'000;  // buckets of a line in all runs: some megabytes for two observers
  FigureChoice choice{.object = principal_object(summary)};
  choice.buckets = std::clamp<std::size_t>(kAllRuns / std::max<std::size_t>(1, runs.size()), 100, 700);
  Vec3 range = Vec3::Zero(), bend = Vec3::Zero();  // the greatest of any run
  for (const measure::RunRecord& run : runs) {
    const measure::ObjectInfo* object = find_object(run, choice.object);
    const std::vector<PathPoint> truth = object != nullptr ? truth_of(run, *object) : std::vector<PathPoint>{};
    for (int c = 0; c < 3; ++c) {
      const auto [whole, bent] = range_and_bend(component_of(truth, c));
      range[c] = std::max(range[c], whole);
      bend[c] = std::max(bend[c], bent);
    }
  }
  // For a straight line only rounding is left.
  const bool straight = bend.maxCoeff() <= 1e-9 * range.maxCoeff();
  Eigen::Index best = 0;
  (straight ? range : bend).maxCoeff(&best);
  choice.component = static_cast<int>(best);
  return choice;
}

Json run_data(const measure::ScenarioInfo& info, const measure::RunRecord& run, std::size_t number,
              const FigureChoice& choice) {
  std::vector<std::string> keys, peers;
  for (const auto& item : run.params.items()) keys.push_back(item.key());
  for (const measure::PeerInfo& peer : run.peers) peers.push_back(peer.name);
  const measure::ObjectInfo* const object = find_object(run, choice.object);
  Json data{{"title", keys.empty() ? info.name : measure::describe(run.params, keys)},
            {"scenario", info.name},
            {"origin", info.mode + ", seed " + std::to_string(info.seed)},
            {"number", number},
            {"duration_s", run.duration_s},
            {"scale", measure::value_text(run.params, "network.latency_ms")},
            {"peers", peers},
            {"bin_s", output_bin_s(run.duration_s)},
            {"output", output_data(run, object)},
            {"contacts", contacts_data(run, object)},
            {"events", Json::array()}};
  for (const measure::EventMark& event : run.events)
    data["events"].push_back({{"at", event.t_s}, {"name", event.name}});
  if (object == nullptr) return data;
  data["object"] = object->path;
  data["owner"] = measure::peer_name(run, object->owner);
  data["component"] = std::string{"xyz"[choice.component]};
  data["truth"] = curve(thinned(component_of(truth_of(run, *object), choice.component), choice.buckets));
  data["updates"] = updates_data(run, object->object);
  data["observers"] = Json::array();
  for (const measure::PeerInfo& observer : observers_of(run, *object))
    data["observers"].push_back(observer_data(run, observer, object->object, choice));
  return data;
}

Figures make_figures(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs, const Json& summary) {
  const FigureChoice choice = figure_choice(runs, summary);
  Figures figures{.sweep = sweep_data(summary),
                  .overview = overview_figure(summary),
                  .pareto = pareto_figure(summary),
                  .plan = plan_figure(info, runs, summary),
                  .runs = {}};
  for (std::size_t i = 0; i < runs.size(); ++i) figures.runs.push_back(run_data(info, runs[i], i + 1, choice));
  return figures;
}

}  // namespace peerd::report
