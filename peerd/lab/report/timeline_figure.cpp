#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/output_rates.hpp"
#include "peerd/lab/report/time_figure_layout.hpp"

namespace peerd::report {
namespace {

struct TimelineLayout : TimeFigureLayout {  // [px]
  static constexpr Box kRateBox{kLeft, 86.0, kPlotWidth, 130.0};
  static constexpr Box kThresholdBox{kLeft, 256.0, kPlotWidth, 110.0};
  static constexpr double kLanesTop = 406.0;
  static constexpr double kLane = 26.0;  // height of a peer's lane
};

constexpr std::size_t kMostCurves = 6;    // number of colours that can be told apart
constexpr std::size_t kMostLanes = 10;    // number of peers
constexpr std::size_t kMostMarks = 3000;  // more marks make a black bar, and megabytes

// The curve of a value that holds from one point to the next.
std::vector<Point> stepped(const std::vector<Point>& points, double end_x) {
  std::vector<Point> steps;
  for (std::size_t i = 0; i < points.size(); ++i) {
    steps.push_back(points[i]);
    steps.push_back({i + 1 < points.size() ? points[i + 1].x : end_x, points[i].y});
  }
  return steps;
}

std::vector<Point> rate_steps(const std::vector<double>& rates, double duration_s) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    points.push_back({static_cast<double>(i) * output_bin_s(duration_s), rates[i]});
  }
  return stepped(points, duration_s);
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Draws a curve for each of the peers that send most. The others are counted in the legend.
void draw_rates(Svg& svg, const measure::RunRecord& run, const Panel& panel) {
  panel.draw_axes(svg, {.y = "sent [kB/s]", .x_ticks = 16, .y_ticks = 5});
  struct Sender {
    std::string name;
    std::vector<double> rates;
    double mean = 0.0;
  };
  std::vector<Sender> senders;
  for (const measure::PeerInfo& peer : run.peers) {
    senders.push_back({peer.name, output_rates(run, peer.peer), 0.0});
    senders.back().mean = mean_of(senders.back().rates);
  }
  std::ranges::stable_sort(senders, std::ranges::greater{}, &Sender::mean);
  std::vector<LegendEntry> legend;
  const std::size_t drawn = std::min(kMostCurves, senders.size());
  for (std::size_t i = drawn; i-- > 0;) {  // the greatest is drawn last, on top
    panel.draw_curve(svg, rate_steps(senders[i].rates, run.duration_s), observer_stroke(i));
  }
  for (std::size_t i = 0; i < drawn; ++i) {
    legend.push_back({LegendEntry::Mark::kLine, observer_stroke(i),
                      senders[i].name + (i == 0 ? ", mean " : " ") + tick_label(senders[i].mean, 2)});
  }
  if (drawn < senders.size()) {
    legend.push_back(
        {LegendEntry::Mark::kLine, {.opacity = 0.0}, std::to_string(senders.size() - drawn) + " others not drawn"});
  }
  draw_legend(svg, {TimelineLayout::kLeft, TimelineLayout::kRateBox.y - 9.0}, TimelineLayout::kPlotWidth, legend);
}

// Draws the threshold of each update as valid until the next one. Changes in between are not published.
void draw_thresholds(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& object, const Panel& panel) {
  panel.draw_axes(svg, {.y = "threshold [m]", .x_ticks = 16, .y_ticks = 5});
  std::vector<Point> points;
  for (const measure::UpdateSent& u : run.updates) {
    if (u.object == object.object) points.push_back({u.t_s, u.threshold_m});
  }
  const Stroke stroke{.colour = colour_of(0), .width = 1.5};
  panel.draw_curve(svg, stepped(points, run.duration_s), stroke);
  // Updates are marked as long as the marks can be told apart.
  if (static_cast<double>(points.size()) < 0.5 * TimelineLayout::kPlotWidth) {
    for (const Point& p : points) svg.circle(panel.at(p.x, p.y), 2.2, colour_of(0), stroke);
  }
  const std::vector<LegendEntry> legend{{LegendEntry::Mark::kLine, stroke,
                                         "error threshold of " + object.path + " at each of its " +
                                             std::to_string(updates_sent(run, object.object)) + " updates"}};
  draw_legend(svg, {TimelineLayout::kLeft, TimelineLayout::kThresholdBox.y - 9.0}, TimelineLayout::kPlotWidth, legend);
}

enum class ContactMark : std::uint8_t { kHappened, kDecided, kPredicted, kWrong, kApplied };

// The mark of a contact's row; none for a row that only repeats another.
std::optional<ContactMark> mark_of(const measure::ContactRow& contact, measure::Verdict verdict) {
  switch (verdict) {
    case measure::Verdict::kOutcome:
      return contact.kind == "decided" ? ContactMark::kDecided : ContactMark::kHappened;
    case measure::Verdict::kAgreed:
      return contact.kind == "applied" ? ContactMark::kApplied : ContactMark::kPredicted;
    case measure::Verdict::kDisagreed:
    case measure::Verdict::kSpurious:
      return ContactMark::kWrong;
    case measure::Verdict::kRepeated:
    case measure::Verdict::kRevised:
    case measure::Verdict::kOwn:
      return std::nullopt;
  }
  return std::nullopt;
}

void draw_mark(Svg& svg, Point at, ContactMark mark) {
  switch (mark) {
    case ContactMark::kHappened:
      svg.rect({at.x - 3.5, at.y - 3.5, 7.0, 7.0}, kBarColour);
      break;
    case ContactMark::kDecided:
      svg.rect({at.x - 4.0, at.y - 4.0, 8.0, 8.0}, colour_of(0));
      break;
    case ContactMark::kPredicted:
      svg.circle(at, 3.5, "none", {.colour = colour_of(2), .width = 1.5});
      break;
    case ContactMark::kApplied:
      svg.circle(at, 3.5, colour_of(4), {.colour = colour_of(4)});
      break;
    case ContactMark::kWrong:
      svg.cross(at, 4.0, {.colour = colour_of(1), .width = 1.8});
      break;
  }
}

std::vector<LegendEntry> lanes_legend(std::span<const std::size_t> counts) {
  using Mark = LegendEntry::Mark;
  struct Kind {
    Mark mark;
    Stroke stroke;
    std::string_view label;
  };
  const std::array kinds{Kind{Mark::kSquare, {.colour = kBarColour}, " to an own object"},
                         Kind{Mark::kSquare, {.colour = colour_of(0)}, " decided"},
                         Kind{Mark::kCircle, {.colour = colour_of(2), .width = 1.5}, " predicted"},
                         Kind{Mark::kCross, {.colour = colour_of(1), .width = 1.8}, " wrong"},
                         Kind{Mark::kDisc, {.colour = colour_of(4)}, " taken over"}};
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (counts[i] > 0)
      legend.push_back({kinds[i].mark, kinds[i].stroke, std::to_string(counts[i]) + std::string(kinds[i].label)});
  }
  return legend;
}

// Draws a lane for each peer with its statements about contacts at the contact's time, and a line to when the peer
// knew.
void draw_lanes(Svg& svg, const measure::RunRecord& run, std::size_t lanes, const Panel& panel) {
  panel.draw_axes(svg, {.x = "time [s]", .x_ticks = 16, .y_ticks = 0});
  const auto middle = [](std::size_t lane) {
    return TimelineLayout::kLanesTop + TimelineLayout::kLane * (static_cast<double>(lane) + 0.5);
  };
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if (lane > 0) {
      const double y = TimelineLayout::kLanesTop + TimelineLayout::kLane * static_cast<double>(lane);
      svg.line({TimelineLayout::kLeft, y}, {TimelineLayout::kLeft + TimelineLayout::kPlotWidth, y},
               {.colour = kGridColour});
    }
    svg.text({TimelineLayout::kLeft - 8.0, middle(lane) + 4.0},
             shortened(run.peers[lane].name, TimelineLayout::kLeft - 12.0, 11.0),
             {.size = 11.0, .anchor = Anchor::kEnd});
  }
  const measure::Agreement judged = agreement(run);
  std::array<std::size_t, 5> counts{};
  std::size_t drawn = 0;
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const measure::ContactRow& c = run.contacts[i];
    const std::optional<ContactMark> mark = mark_of(c, judged.verdicts[i]);
    if (!mark || !std::isfinite(c.t_s)) continue;
    const auto lane =
        static_cast<std::size_t>(std::ranges::find(run.peers, c.peer, &measure::PeerInfo::peer) - run.peers.begin());
    ++counts[static_cast<std::size_t>(*mark)];
    if (lane >= lanes || drawn >= kMostMarks) {
      ++left_out;
      continue;
    }
    ++drawn;
    const double y = middle(lane);
    const double known_s = std::clamp(c.reported_at_s, 0.0, run.duration_s);
    if (std::isfinite(known_s) && std::fabs(panel.px(known_s) - panel.px(c.t_s)) > 4.0)
      svg.line({panel.px(c.t_s), y}, {panel.px(known_s), y}, {.colour = kContactColour});
    draw_mark(svg, {panel.px(c.t_s), y}, *mark);
  }
  std::vector<LegendEntry> legend = lanes_legend(counts);
  using Mark = LegendEntry::Mark;
  if (legend.empty()) {
    legend.push_back({Mark::kLine, {.opacity = 0.0}, "no contacts"});
  } else {
    legend.push_back({Mark::kLine, {.colour = kContactColour}, "until it knew"});
  }
  if (left_out > 0) legend.push_back({Mark::kLine, {.opacity = 0.0}, std::to_string(left_out) + " not drawn"});
  draw_legend(svg, {TimelineLayout::kLeft, TimelineLayout::kLanesTop - 9.0}, TimelineLayout::kPlotWidth, legend);
}

}  // namespace

std::string timeline_figure(const measure::ScenarioInfo& info, const measure::RunRecord& run, std::size_t number,
                            const FigureFrame& frame) {
  const std::size_t lanes = std::min(run.peers.size(), kMostLanes);
  Svg svg(TimelineLayout::kWidth,
          TimelineLayout::kLanesTop + TimelineLayout::kLane * static_cast<double>(lanes) + 52.0);
  std::string subtitle = info.name + ", run " + std::to_string(number) +
                         ": what each peer sends, thresholds in force, contacts by who says so";
  if (lanes < run.peers.size())
    subtitle += " (of " + std::to_string(lanes) + " of " + std::to_string(run.peers.size()) + " peers)";
  draw_title(svg, {TimelineLayout::kLeft, 28.0}, TimelineLayout::kPlotWidth, run_title(info, run), subtitle);
  const Range time{0.0, run.duration_s};
  const Panel rates(TimelineLayout::kRateBox, time, from_zero(frame.peer_rate_max_kB_s));
  const Panel thresholds(TimelineLayout::kThresholdBox, time, from_zero(frame.threshold_max_m));
  const auto count = static_cast<double>(lanes);
  const Panel contacts(
      {TimelineLayout::kLeft, TimelineLayout::kLanesTop, TimelineLayout::kPlotWidth, TimelineLayout::kLane * count},
      time, {0.0, count});
  std::vector<const Panel*> drawn{&rates};
  draw_rates(svg, run, rates);
  if (const measure::ObjectInfo* object = find_object(run, frame.object)) {
    draw_thresholds(svg, run, *object, thresholds);
    drawn.push_back(&thresholds);
  }
  if (lanes > 0) {
    draw_lanes(svg, run, lanes, contacts);
    drawn.push_back(&contacts);
  }
  draw_events(svg, run, drawn);
  return std::move(svg).finish();
}

}  // namespace peerd::report
