#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/output_rates.hpp"
#include "peerd/lab/report/table.hpp"
#include "peerd/lab/report/time_figure_layout.hpp"

namespace peerd::report {
namespace {

struct RunLayout : TimeFigureLayout {  // [px]
  static constexpr double kHeight = 728.0;
  static constexpr Box kPositionBox{kLeft, 86.0, kPlotWidth, 210.0};
  static constexpr Box kErrorBox{kLeft, 336.0, kPlotWidth, 170.0};
  static constexpr Box kRateBox{kLeft, 546.0, kPlotWidth, 130.0};
};

int component_of(std::span<const measure::RunRecord> runs, const std::string& path) {
  Vec3 bend = Vec3::Zero();   // greatest range without the straight line
  Vec3 range = Vec3::Zero();  // greatest range with it, for objects that go straight
  for (const measure::RunRecord& run : runs) {
    const measure::ObjectInfo* object = find_object(run, path);
    const std::vector<measure::PeerInfo> observers =
        object ? observers_of(run, *object) : std::vector<measure::PeerInfo>{};
    if (observers.empty()) continue;
    const auto series = measure::ghost_samples_of(run, observers.front().peer, object->object);
    const measure::GhostSample& first = series.front();
    const measure::GhostSample& last = series.back();
    for (int c = 0; c < 3; ++c) {
      Range bent;
      Range plain;
      for (const measure::GhostSample& s : series) {
        const double along = last.t_s > first.t_s ? (s.t_s - first.t_s) / (last.t_s - first.t_s) : 0.0;
        bent.add(s.truth.position[c] - std::lerp(first.truth.position[c], last.truth.position[c], along));
        plain.add(s.truth.position[c]);
      }
      if (!bent.empty()) bend[c] = std::max(bend[c], bent.hi - bent.lo);
      if (!plain.empty()) range[c] = std::max(range[c], plain.hi - plain.lo);
    }
  }
  // For a straight line only rounding is left.
  const bool straight = bend.maxCoeff() <= 1e-9 * range.maxCoeff();
  Eigen::Index best = 0;
  (straight ? range : bend).maxCoeff(&best);
  return static_cast<int>(best);
}

std::optional<Point> ghost_at(const ErrorSeries& series, double t_s) {
  const auto it = std::ranges::lower_bound(series.ghost, t_s, {}, &Point::x);
  if (it == series.ghost.end() || !(std::fabs(it->y) < 1e100)) return std::nullopt;
  return *it;
}

struct Marks {
  std::vector<double> contacts_s;
  std::uint64_t updates = 0;
  std::size_t right = 0;
  std::size_t wrong = 0;
};

// Draws contacts of the object as vertical lines, and its updates as a comb on the time axis.
Marks draw_instants(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& object,
                    const measure::Agreement& judged, const Panel& position, const Panel& error) {
  Marks marks{.contacts_s = {}, .updates = updates_sent(run, object.object)};
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const measure::ContactRow& c = run.contacts[i];
    if (judged.verdicts[i] != measure::Verdict::kOutcome ||
        (c.collider != object.object && c.collidee != object.object))
      continue;
    marks.contacts_s.push_back(c.t_s);
    for (const Panel* panel : {&position, &error}) {
      const double x = panel->px(c.t_s);
      svg.line({x, panel->box().y}, {x, panel->box().y + panel->box().height},
               {.colour = kContactColour, .dashes = "2 3"});
    }
  }
  const double bottom = RunLayout::kPositionBox.y + RunLayout::kPositionBox.height;
  for (const measure::UpdateSent& u : run.updates) {
    if (u.object != object.object) continue;
    svg.line({position.px(u.t_s), bottom - 9.0}, {position.px(u.t_s), bottom}, {.colour = "#222"});
  }
  return marks;
}

// Marks the places where an observer's ghost met something as predicted: a ring if that is the outcome, a cross if
// there was no such outcome or it was on the other side.
void draw_predictions(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& object,
                      const measure::Agreement& judged, PeerId observer, const ErrorSeries& series,
                      std::string_view colour, const Panel& position, Marks& marks) {
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const measure::ContactRow& c = run.contacts[i];
    if (c.peer != observer || (c.collider != object.object && c.collidee != object.object)) continue;
    const measure::Verdict v = judged.verdicts[i];
    const bool wrong = v == measure::Verdict::kDisagreed || v == measure::Verdict::kSpurious;
    if (!wrong && v != measure::Verdict::kAgreed) continue;
    const std::optional<Point> ghost = ghost_at(series, c.t_s);
    if (!ghost) continue;
    ++(wrong ? marks.wrong : marks.right);
    const Point at = position.at(ghost->x, ghost->y);
    const Stroke stroke{.colour = colour, .width = 1.5};
    if (wrong) {
      svg.cross(at, 4.5, stroke);
    } else {
      svg.circle(at, 4.0, "none", stroke);
    }
  }
}

void draw_rates(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& object, const Panel& panel) {
  panel.draw_axes(svg, {.x = "time [s]", .y = "output [kB/s]", .x_ticks = 16, .y_ticks = 5});
  const double width_s = output_bin_s(run.duration_s);
  const std::vector<double> rates = output_rates(run, object.owner);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const double begin_s = static_cast<double>(i) * width_s;
    const Point top = panel.at(begin_s, rates[i]);
    const double right = panel.px(std::min(begin_s + width_s, run.duration_s));
    const double gap = right - top.x > 6.0 ? 1.0 : 0.0;
    svg.rect({top.x + gap, top.y, std::max(0.2, right - top.x - 2.0 * gap),
              RunLayout::kRateBox.y + RunLayout::kRateBox.height - top.y},
             kBarColour);
  }
  const double mean =
      rates.empty() ? 0.0 : std::accumulate(rates.begin(), rates.end(), 0.0) / static_cast<double>(rates.size());
  svg.text({RunLayout::kLeft, RunLayout::kRateBox.y - 9.0},
           "everything that " + measure::peer_name(run, object.owner) + " sends, mean " + tick_label(mean, 2) + " kB/s",
           {.size = 11.0});
}

}  // namespace

FigureFrame figure_frame(std::span<const measure::RunRecord> runs, const nlohmann::ordered_json& summary) {
  FigureFrame frame;
  frame.object = principal_object(summary);
  frame.component = component_of(runs, frame.object);
  for (const measure::RunRecord& run : runs) {
    const measure::ObjectInfo* object = find_object(run, frame.object);
    if (object == nullptr) continue;
    Range& position = frame.position_m[latency_text(run)];
    Range& error = frame.error_m[latency_text(run)];
    error.add(0.0);
    for (const measure::PeerInfo& observer : observers_of(run, *object)) {
      for (const measure::GhostSample& s : measure::ghost_samples_of(run, observer.peer, object->object)) {
        position.add(s.truth.position[frame.component]);
        position.add(s.ghost.position[frame.component]);
        error.add(measure::ghost_error_m(s));
      }
    }
    for (const double rate : output_rates(run, object->owner))
      frame.rate_max_kB_s = std::max(frame.rate_max_kB_s, rate);
    for (const measure::UpdateSent& u : run.updates) {
      if (u.object == object->object) frame.threshold_max_m = std::max(frame.threshold_max_m, u.threshold_m);
    }
    for (const measure::PeerInfo& peer : run.peers) {
      for (const double rate : output_rates(run, peer.peer))
        frame.peer_rate_max_kB_s = std::max(frame.peer_rate_max_kB_s, rate);
    }
  }
  return frame;
}

std::string run_figure(const measure::ScenarioInfo& info, const measure::RunRecord& run, std::size_t number,
                       const FigureFrame& frame) {
  Svg svg(RunLayout::kWidth, RunLayout::kHeight);
  const measure::ObjectInfo* object = find_object(run, frame.object);
  std::string subtitle =
      info.name + " (" + info.mode + ", seed " + std::to_string(info.seed) + "), run " + std::to_string(number);
  if (object == nullptr) {
    draw_title(svg, {RunLayout::kLeft, 28.0}, RunLayout::kPlotWidth, run_title(info, run),
               subtitle + ": no object that another peer observes");
    return std::move(svg).finish();
  }
  subtitle += ": " + object->path + ", run by " + measure::peer_name(run, object->owner);
  draw_title(svg, {RunLayout::kLeft, 28.0}, RunLayout::kPlotWidth, run_title(info, run), subtitle);

  Range position_range = drawable(frame.position_m.at(latency_text(run)));
  const double room = 0.06 * (position_range.hi - position_range.lo);
  position_range = {position_range.lo - 2.0 * room, position_range.hi + room};  // the comb of updates needs room below
  const Panel position(RunLayout::kPositionBox, {0.0, run.duration_s}, position_range);
  const Panel error(RunLayout::kErrorBox, {0.0, run.duration_s}, from_zero(frame.error_m.at(latency_text(run)).hi));
  const Panel rates(RunLayout::kRateBox, {0.0, run.duration_s}, from_zero(frame.rate_max_kB_s));
  position.draw_axes(svg, {.y = component_name(frame.component) + " [m]", .x_ticks = 16});
  error.draw_axes(svg, {.y = "ghost error [m]", .x_ticks = 16});
  draw_rates(svg, run, *object, rates);
  draw_events(svg, run, std::array{&position, &error, &rates});

  const measure::Agreement judged = agreement(run);
  Marks marks = draw_instants(svg, run, *object, judged, position, error);
  using Mark = LegendEntry::Mark;
  std::vector<LegendEntry> above_position{{Mark::kLine, {.colour = kTruthColour, .width = 4.0}, "truth"}};
  std::vector<LegendEntry> above_error;
  const std::vector<measure::PeerInfo> observers = observers_of(run, *object);
  std::vector<ErrorSeries> all;
  for (const measure::PeerInfo& observer : observers) {
    all.push_back(error_series(run, observer.peer, object->object, frame.component));
  }
  position.draw_curve(svg, component_over_time(truth_of(run, *object), frame.component),
                      {.colour = kTruthColour, .width = 4.0});
  for (std::size_t i = 0; i < observers.size(); ++i) {
    position.draw_curve(svg, all[i].ghost, observer_stroke(i));
    error.draw_curve(svg, all[i].error, observer_stroke(i));
    above_position.push_back({Mark::kLine, observer_stroke(i), "ghost at " + observers[i].name});
    above_error.push_back(
        {Mark::kLine, observer_stroke(i), "at " + observers[i].name + ", mean " + tick_label(all[i].mean_m, 3) + " m"});
  }
  for (std::size_t i = 0; i < observers.size(); ++i) {
    draw_predictions(svg, run, *object, judged, observers[i].peer, all[i], colour_of(i), position, marks);
  }
  above_position.push_back({Mark::kUpright, {.colour = "#222"}, std::to_string(marks.updates) + " updates"});
  if (!marks.contacts_s.empty())
    above_position.push_back({Mark::kUpright, {.colour = kContactColour, .dashes = "2 3"}, "contact"});
  if (marks.right > 0) above_position.push_back({Mark::kCircle, {.colour = "#222", .width = 1.5}, "predicted"});
  if (marks.wrong > 0) above_position.push_back({Mark::kCross, {.colour = "#222", .width = 1.5}, "mispredicted"});
  draw_legend(svg, {RunLayout::kLeft, RunLayout::kPositionBox.y - 9.0}, RunLayout::kPlotWidth, above_position);
  draw_legend(svg, {RunLayout::kLeft, RunLayout::kErrorBox.y - 9.0}, RunLayout::kPlotWidth, above_error);
  return std::move(svg).finish();
}

}  // namespace peerd::report
