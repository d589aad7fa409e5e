#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/output_rates.hpp"

namespace peerd::report {
namespace {

constexpr std::size_t kMostColumns = 7;
constexpr std::size_t kMostRows = 8;
constexpr std::size_t kMostColours = 4;

struct MultiplesLayout {  // [px]
  static constexpr double kPlotWidth = 260.0;
  static constexpr double kLeft = 62.0;                                    // width of the numbers beside a plot
  static constexpr double kPitch = 330.0;                                  // from one column to the next
  static constexpr double kTop = 96.0;                                     // height of the title and the legend
  static constexpr double kPosition = 104.0, kError = 76.0, kRate = 52.0;  // heights of a picture's three plots
  static constexpr double kGap = 12.0;                                     // between two plots of a picture
  static constexpr double kAxis = 48.0;  // height of the time axis with its numbers and its name
  static constexpr double kLine = 14.0;  // height of a line of text
};

struct Key {
  std::string name;
  std::vector<std::string> values;  // in order of appearance; numbers by size
  bool numeric = true;
};

Key key_of(const std::string& name, std::span<const measure::RunRecord> runs) {
  Key key{.name = name, .values = {}};
  std::vector<std::pair<double, std::string>> found;
  for (const measure::RunRecord& run : runs) {
    const std::string text = measure::value_text(run.params, name);
    const auto it = run.params.find(name);
    key.numeric = key.numeric && it != run.params.end() && it->is_number();
    if (std::ranges::find(found, text, &std::pair<double, std::string>::second) == found.end())
      found.emplace_back(key.numeric ? it->get<double>() : 0.0, text);
  }
  if (key.numeric) std::ranges::sort(found);
  for (auto& [number, text] : found) key.values.push_back(std::move(text));
  return key;
}

// The keys of columns, rows and colours. A key that the sweep does not have is an empty name with one value.
struct Layout {
  Key columns, rows, colours;
};

std::optional<Layout> layout_of(std::span<const measure::RunRecord> runs) {
  std::vector<measure::Params> params;
  for (const measure::RunRecord& run : runs) params.push_back(run.params);
  std::vector<Key> keys;
  for (const std::string& name : measure::varying_keys(params)) keys.push_back(key_of(name, runs));
  if (keys.empty() || keys.size() > 3) return std::nullopt;
  const auto take = [&](auto rank) {
    if (keys.empty()) return Key{.name = "", .values = {""}};
    const auto best = std::ranges::max_element(keys, {}, rank);
    Key key = std::move(*best);
    keys.erase(best);
    return key;
  };
  Layout layout;
  layout.columns = take([](const Key& k) { return std::pair(k.numeric, k.values.size()); });
  layout.rows = take([](const Key& k) { return k.values.size(); });
  layout.colours = take([](const Key& k) { return k.values.size(); });
  if (layout.columns.values.size() > kMostColumns || layout.rows.values.size() > kMostRows ||
      layout.colours.values.size() > kMostColours)
    return std::nullopt;
  return layout;
}

const measure::RunRecord* find_run(std::span<const measure::RunRecord> runs, const Layout& layout, std::size_t row,
                                   std::size_t column, std::size_t colour) {
  const auto is = [](const measure::RunRecord& run, const Key& key, std::size_t i) {
    return key.name.empty() || measure::value_text(run.params, key.name) == key.values[i];
  };
  for (const measure::RunRecord& run : runs) {
    if (is(run, layout.rows, row) && is(run, layout.columns, column) && is(run, layout.colours, colour)) return &run;
  }
  return nullptr;
}

std::vector<std::string> key_names(const Layout& layout) {
  std::vector<std::string> names;
  for (const Key* key : {&layout.rows, &layout.columns, &layout.colours}) {
    if (!key->name.empty()) names.push_back(key->name);
  }
  return names;
}

Stroke colour_stroke(std::size_t i) { return {.colour = colour_of(i), .width = 1.3, .dashes = i == 0 ? "" : "5 3"}; }

// The one observer that is drawn: the first observer of the first run that has any.
std::optional<measure::PeerInfo> observer_of(std::span<const measure::RunRecord> runs, const std::string& path) {
  for (const measure::RunRecord& run : runs) {
    const measure::ObjectInfo* object = find_object(run, path);
    if (object == nullptr) continue;
    const std::vector<measure::PeerInfo> observers = observers_of(run, *object);
    if (!observers.empty()) return observers.front();
  }
  return std::nullopt;
}

struct Picture {
  Panel position, error, rate;
};

Picture draw_frames(Svg& svg, Point at, const measure::RunRecord& run, const FigureFrame& frame) {
  const Range time{0.0, run.duration_s};
  const auto latency = latency_text(run);
  const auto range_of = [&](const std::map<std::string, Range>& ranges) {
    const auto it = ranges.find(latency);
    return it != ranges.end() ? drawable(it->second) : drawable({});
  };
  Range position = range_of(frame.position_m);
  const double room = 0.06 * (position.hi - position.lo);
  position = {position.lo - 2.5 * room, position.hi + room};  // the combs of updates need room below
  const double error_y = at.y + MultiplesLayout::kPosition + MultiplesLayout::kGap;
  const double rate_y = error_y + MultiplesLayout::kError + MultiplesLayout::kGap;
  Picture picture{
      Panel({at.x, at.y, MultiplesLayout::kPlotWidth, MultiplesLayout::kPosition}, time, position),
      Panel({at.x, error_y, MultiplesLayout::kPlotWidth, MultiplesLayout::kError}, time,
            from_zero(range_of(frame.error_m).hi)),
      Panel({at.x, rate_y, MultiplesLayout::kPlotWidth, MultiplesLayout::kRate}, time, from_zero(frame.rate_max_kB_s))};
  picture.position.draw_axes(svg, {.y = component_name(frame.component) + " [m]", .x_ticks = 9, .y_ticks = 6});
  picture.error.draw_axes(svg, {.y = "error [m]", .x_ticks = 9, .y_ticks = 5});
  picture.rate.draw_axes(svg, {.x = "time [s]", .y = "kB/s", .x_ticks = 9, .y_ticks = 3});
  return picture;
}

void draw_contacts(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& object, const Picture& picture) {
  const measure::Agreement judged = agreement(run);
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const measure::ContactRow& c = run.contacts[i];
    if (judged.verdicts[i] != measure::Verdict::kOutcome ||
        (c.collider != object.object && c.collidee != object.object))
      continue;
    for (const Panel* panel : {&picture.position, &picture.error}) {
      const double x = panel->px(c.t_s);
      svg.line({x, panel->box().y}, {x, panel->box().y + panel->box().height},
               {.colour = kContactColour, .dashes = "2 3"});
    }
  }
}

struct Drawn {
  std::uint64_t updates = 0;
  double mean_m = 0.0;
};

Drawn draw_run(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& object, PeerId observer,
               std::size_t colour, const Picture& picture, int component) {
  const ErrorSeries series = error_series(run, observer, object.object, component);
  const Stroke stroke = colour_stroke(colour);
  picture.position.draw_curve(svg, series.ghost, stroke);
  picture.error.draw_curve(svg, series.error, stroke);
  std::vector<Point> rates;
  const double bin_s = output_bin_s(run.duration_s);
  for (const double rate : output_rates(run, object.owner)) {
    const std::size_t bin = rates.size() / 2;  // each bin is two points
    const double begin_s = static_cast<double>(bin) * bin_s;
    rates.push_back({begin_s, rate});
    rates.push_back({std::min(begin_s + bin_s, run.duration_s), rate});
  }
  picture.rate.draw_curve(svg, rates, stroke);

  constexpr double kTooth = 6.0;
  const Box& box = picture.position.box();
  const double bottom = box.y + box.height - kTooth * static_cast<double>(colour);
  const Drawn drawn{.updates = updates_sent(run, object.object), .mean_m = series.mean_m};
  for (const measure::UpdateSent& u : run.updates) {
    if (u.object != object.object) continue;
    const double x = picture.position.px(u.t_s);
    svg.line({x, bottom - kTooth + 1.0}, {x, bottom}, {.colour = stroke.colour});
  }
  return drawn;
}

void draw_picture(Svg& svg, Point at, std::span<const measure::RunRecord> runs, const Layout& layout, std::size_t row,
                  std::size_t column, const FigureFrame& frame, const measure::PeerInfo& observer) {
  const std::vector<std::string> names = key_names(layout);
  const std::size_t number = row * layout.columns.values.size() + column + 1;
  std::optional<Picture> picture;
  double line_y = at.y + 4.0;
  const double plots_y = at.y + MultiplesLayout::kLine * static_cast<double>(layout.colours.values.size()) + 14.0;
  for (std::size_t colour = 0; colour < layout.colours.values.size(); ++colour) {
    const measure::RunRecord* run = find_run(runs, layout, row, column, colour);
    const measure::ObjectInfo* object = run ? find_object(*run, frame.object) : nullptr;
    if (object == nullptr) continue;
    if (!picture) {
      std::vector<std::string> in_common = names;
      std::erase(in_common, layout.colours.name);
      const std::string title = std::to_string(number);
      const double title_width = text_width(title + "  ", 12.0);
      svg.text({at.x, at.y - 12.0}, title, {.size = 12.0, .bold = true});
      const std::string words = measure::describe(run->params, in_common);
      const double room = (MultiplesLayout::kPlotWidth - title_width) / 1.12;  // bold letters are wider
      const double size = std::clamp(12.0 * room / (text_width(words, 12.0) + 1.0), 9.0, 12.0);
      svg.text({at.x + title_width, at.y - 12.0}, shortened(words, room, size), {.size = size, .bold = true});
      picture = draw_frames(svg, {at.x, plots_y}, *run, frame);
      draw_contacts(svg, *run, *object, *picture);
      picture->position.draw_curve(svg, component_over_time(truth_of(*run, *object), frame.component),
                                   {.colour = kTruthColour, .width = 3.0});
    }
    const Drawn drawn = draw_run(svg, *run, *object, observer.peer, colour, *picture, frame.component);
    const std::string name =
        layout.colours.name.empty() ? "" : measure::describe(run->params, layout.colours.name, names) + ": ";
    svg.line({at.x, line_y - 4.0}, {at.x + 18.0, line_y - 4.0}, colour_stroke(colour));
    svg.text({at.x + 24.0, line_y},
             shortened(name + std::to_string(drawn.updates) + " updates, mean " + short_label(drawn.mean_m, 3) + " m",
                       MultiplesLayout::kPlotWidth - 24.0, 11.0),
             {.size = 11.0});
    line_y += MultiplesLayout::kLine;
  }
}

}  // namespace

std::string multiples_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                             const FigureFrame& frame) {
  const std::optional<Layout> layout = layout_of(runs);
  const std::optional<measure::PeerInfo> observer = observer_of(runs, frame.object);
  if (!layout || !observer) return "";
  const std::size_t columns = layout->columns.values.size(), rows = layout->rows.values.size();
  const std::size_t colours = layout->colours.values.size();
  const double row_pitch = MultiplesLayout::kLine * static_cast<double>(colours) + 40.0 + MultiplesLayout::kPosition +
                           MultiplesLayout::kGap + MultiplesLayout::kError + MultiplesLayout::kGap +
                           MultiplesLayout::kRate + MultiplesLayout::kAxis;
  const double width = MultiplesLayout::kPitch * static_cast<double>(columns) + 10.0;
  Svg svg(width, MultiplesLayout::kTop + row_pitch * static_cast<double>(rows) + 4.0);

  std::string subtitle =
      info.mode + ", seed " + std::to_string(info.seed) + "; one scale for each latency, one for output";
  const std::size_t drawn = columns * rows * colours;
  if (runs.size() > drawn)
    subtitle += "; " + std::to_string(runs.size() - drawn) + " runs repeat others and are left out";
  draw_title(svg, {MultiplesLayout::kLeft, 28.0}, width - MultiplesLayout::kLeft - 20.0,
             info.name + ": " + frame.object + " and its ghost at " + observer->name + ", run by run", subtitle);
  using Mark = LegendEntry::Mark;
  std::vector<LegendEntry> legend{{Mark::kLine, {.colour = kTruthColour, .width = 3.0}, "truth"}};
  const std::vector<std::string> names = key_names(*layout);
  for (std::size_t i = 0; i < colours; ++i) {
    const measure::RunRecord* run = nullptr;
    for (const measure::RunRecord& r : runs) {
      if (layout->colours.name.empty() ||
          measure::value_text(r.params, layout->colours.name) == layout->colours.values[i])
        run = &r;
    }
    legend.push_back({Mark::kLine, colour_stroke(i),
                      run == nullptr || layout->colours.name.empty()
                          ? "ghost"
                          : "ghost, " + measure::describe(run->params, layout->colours.name, names)});
  }
  legend.push_back({Mark::kUpright, {.colour = colour_of(0)}, "update"});
  legend.push_back({Mark::kUpright, {.colour = kContactColour, .dashes = "2 3"}, "contact"});
  draw_legend(svg, {MultiplesLayout::kLeft, 68.0}, width - MultiplesLayout::kLeft - 20.0, legend);

  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      draw_picture(svg,
                   {MultiplesLayout::kLeft + MultiplesLayout::kPitch * static_cast<double>(column),
                    MultiplesLayout::kTop + 12.0 + row_pitch * static_cast<double>(row)},
                   runs, *layout, row, column, frame, *observer);
    }
  }
  return std::move(svg).finish();
}

}  // namespace peerd::report
