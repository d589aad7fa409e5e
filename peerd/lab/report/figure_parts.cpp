#include "peerd/lab/report/figure_parts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/statistics/statistics.hpp"
#include "peerd/lab/measure/sweep.hpp"

namespace peerd::report {
namespace {

constexpr double kLegendSize = 11.0;
constexpr double kLegendGap = 12.0;

double legend_width(const LegendEntry& entry) { return 26.0 + text_width(entry.label, kLegendSize); }

void draw_mark(Svg& svg, Point at, const LegendEntry& entry) {
  const Point middle{at.x + 10.0, at.y - 4.0};
  switch (entry.mark) {
    case LegendEntry::Mark::kLine:
      svg.line({at.x, middle.y}, {at.x + 20.0, middle.y}, entry.stroke);
      break;
    case LegendEntry::Mark::kUpright:
      svg.line({middle.x, middle.y - 6.0}, {middle.x, middle.y + 6.0}, entry.stroke);
      break;
    case LegendEntry::Mark::kCircle:
      svg.circle(middle, 3.5, "#fff", entry.stroke);
      break;
    case LegendEntry::Mark::kDisc:
      svg.circle(middle, 3.5, entry.stroke.colour, entry.stroke);
      break;
    case LegendEntry::Mark::kCross:
      svg.cross(middle, 3.5, entry.stroke);
      break;
    case LegendEntry::Mark::kSquare:
      svg.rect({middle.x - 3.5, middle.y - 3.5, 7.0, 7.0}, entry.stroke.colour);
      break;
    case LegendEntry::Mark::kOutline: {
      const std::array corners{Point{middle.x - 6.0, middle.y - 4.0}, Point{middle.x + 6.0, middle.y - 4.0},
                               Point{middle.x + 6.0, middle.y + 4.0}, Point{middle.x - 6.0, middle.y + 4.0}};
      svg.polygon(corners, entry.fill.empty() ? entry.stroke.colour : entry.fill, entry.fill_opacity);
      std::vector<Point> edge(corners.begin(), corners.end());
      edge.push_back(corners.front());
      svg.polyline(edge, entry.stroke);
      break;
    }
  }
}

}  // namespace

std::string shortened(const std::string& text, double width, double size) {
  std::size_t begin = 0;
  while (begin < text.size() && text_width(std::string_view(text).substr(begin), size) + size > width) ++begin;
  while (begin < text.size() && (text[begin] & 0xc0) == 0x80) ++begin;  // never begin inside of a UTF-8 character
  return text_width(text, size) <= width ? text : "…" + text.substr(begin);
}

std::vector<std::vector<LegendEntry>> legend_rows(std::span<const LegendEntry> entries, double width) {
  std::vector<std::vector<LegendEntry>> rows;
  double used = 0.0;
  for (const LegendEntry& entry : entries) {
    const double needs = legend_width(entry);
    if (rows.empty() || used + needs > width) {
      rows.emplace_back();
      used = 0.0;
    }
    rows.back().push_back(entry);
    used += needs + kLegendGap;
  }
  return rows;
}

void draw_legend(Svg& svg, Point at, double width, std::span<const LegendEntry> entries) {
  const double end = at.x + width;
  const double more_width = text_width("+ 000", kLegendSize);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const double needs = legend_width(entries[i]);
    const bool last = i + 1 == entries.size();
    if (at.x + needs + (last ? 0.0 : more_width) > end) {
      svg.text(at, "+ " + std::to_string(entries.size() - i), {.size = kLegendSize});
      return;
    }
    draw_mark(svg, at, entries[i]);
    svg.text({at.x + 26.0, at.y}, entries[i].label, {.size = kLegendSize});
    at.x += needs + kLegendGap;
  }
}

void draw_events(Svg& svg, const measure::RunRecord& run, std::span<const Panel* const> panels) {
  constexpr double kSize = 10.0, kRow = 12.0, kGap = 3.0;
  const Box& first = panels.front()->box();
  std::vector<double> row_ends;  // end of the last name of each row
  for (const measure::EventMark& event : run.events) {
    const double x = panels.front()->px(event.t_s);
    for (const Panel* panel : panels) {
      const Box& box = panel->box();
      svg.line({x, box.y}, {x, box.y + box.height}, {.colour = kEventColour, .opacity = 0.7});
    }
    const std::string name = shortened(event.name, 0.25 * first.width, kSize);
    const double width = text_width(name, kSize);
    const bool fits_behind = x + kGap + width <= first.x + first.width;
    const double begin = fits_behind ? x + kGap : x - kGap - width;
    const auto row = static_cast<std::size_t>(std::ranges::find_if(row_ends, [&](double end) { return end <= begin; }) -
                                              row_ends.begin());
    row_ends.resize(std::max(row_ends.size(), row + 1));
    row_ends[row] = begin + width + kGap;
    svg.text({begin, first.y + kRow * static_cast<double>(row + 1)}, name, {.size = kSize, .colour = kEventColour});
  }
}

void draw_title(Svg& svg, Point at, double width, std::string_view title, std::string_view subtitle) {
  constexpr double kSize = 16.0;
  constexpr double kBold = 1.12;  // bold letters are wider
  const double size = std::min(kSize, kSize * width / (kBold * text_width(title, kSize) + 1.0));
  svg.text(at, title, {.size = size, .bold = true});
  svg.text({at.x, at.y + 20.0}, subtitle,
           {.size = std::min(12.0, 12.0 * width / (text_width(subtitle, 12.0) + 1.0)), .colour = "#666"});
}

void draw_bars(Svg& svg, const Box& box, std::string_view title, std::span<const BarEntry> bars, int decimals) {
  svg.text({box.x, box.y - 10.0}, title, {.size = 12.0});
  if (bars.empty()) return;
  double label_width = 0.0;
  Range values;
  values.add(0.0);
  for (const BarEntry& bar : bars) {
    label_width = std::max(label_width, text_width(bar.label, 11.0));
    values.add(bar.value);
  }
  label_width = std::min(label_width, 0.6 * box.width);
  const double sample_width =
      std::ranges::any_of(bars, [](const BarEntry& b) { return b.line.has_value(); }) ? 42.0 : 0.0;
  const double number_width = text_width(tick_label(values.hi, decimals), 11.0) + 8.0;
  const double left = box.x + label_width + sample_width + 8.0;
  const double full = box.width - label_width - sample_width - 8.0 - number_width;
  const double pitch = std::min(kBarPitch, box.height / static_cast<double>(bars.size()));
  const double thick = 0.64 * pitch;
  const double size = std::clamp(0.9 * pitch, 3.0, 11.0);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = box.y + pitch * (static_cast<double>(i) + 0.5);
    const double length =
        values.hi > 0.0 && std::isfinite(bars[i].value) ? full * std::max(0.0, bars[i].value) / values.hi : 0.0;
    svg.text({left - sample_width - 8.0, y + 0.36 * size}, shortened(bars[i].label, label_width + 1.0, size),
             {.size = size, .anchor = Anchor::kEnd});
    if (bars[i].line) svg.line({left - sample_width, y}, {left - 8.0, y}, *bars[i].line);
    svg.rect({left, y - 0.5 * thick, length, thick}, bars[i].colour);
    svg.text({left + length + 6.0, y + 0.36 * size}, tick_label(bars[i].value, decimals), {.size = size});
  }
  const double used = pitch * static_cast<double>(bars.size());
  svg.line({left, box.y}, {left, box.y + used}, {.colour = "#555"});
}

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

std::string latency_text(const measure::RunRecord& run) {
  return measure::value_text(run.params, "network.latency_ms");
}

std::string run_title(const measure::ScenarioInfo& info, const measure::RunRecord& run) {
  std::vector<std::string> keys;
  for (const auto& item : run.params.items()) keys.push_back(item.key());
  return keys.empty() ? info.name : measure::describe(run.params, keys);
}

std::vector<TruthSample> truth_of(const measure::RunRecord& run, const measure::ObjectInfo& object) {
  std::vector<TruthSample> truth;
  for (const measure::PeerInfo& observer : run.peers) {
    for (const measure::GhostSample& s : measure::ghost_samples_of(run, observer.peer, object.object))
      truth.push_back({s.t_s, s.truth.position});
  }
  std::ranges::stable_sort(truth, {}, &TruthSample::t_s);
  const auto repeated = std::ranges::unique(truth, {}, &TruthSample::t_s);
  truth.erase(repeated.begin(), repeated.end());
  return truth;
}

std::vector<Point> component_over_time(std::span<const TruthSample> truth, int component) {
  std::vector<Point> points;
  for (const TruthSample& s : truth) points.push_back({s.t_s, s.position[component]});
  return points;
}

ErrorSeries error_series(const measure::RunRecord& run, PeerId observer, ObjectId object, int component) {
  ErrorSeries series;
  std::vector<double> errors;
  for (const measure::GhostSample& s : measure::ghost_samples_of(run, observer, object)) {
    series.ghost.push_back({s.t_s, s.ghost.position[component]});
    series.error.push_back({s.t_s, measure::ghost_error_m(s)});
    if (std::isfinite(series.error.back().y)) errors.push_back(series.error.back().y);
  }
  const measure::ViewMeasured* const measured = run.measured ? run.measured->whole.view(observer, object) : nullptr;
  series.mean_m = measured != nullptr ? measured->ghost_error_m.mean : measure::statistics(std::move(errors)).mean;
  return series;
}

std::uint64_t updates_sent(const measure::RunRecord& run, ObjectId object) {
  if (!run.measured)
    return static_cast<std::uint64_t>(std::ranges::count(run.updates, object, &measure::UpdateSent::object));
  const auto found = run.measured->whole.updates.find(object);
  return found != run.measured->whole.updates.end() ? found->second.updates : 0;
}

}  // namespace peerd::report
