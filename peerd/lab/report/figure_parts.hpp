#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/svg.hpp"

namespace peerd::report {

// Okabe and Ito's colours, which colour-blind readers can tell apart, without yellow, which is lost on white.
inline constexpr std::array<std::string_view, 6> kColours{"#0072b2", "#d55e00", "#009e73",
                                                          "#cc79a7", "#e69f00", "#56b4e9"};
inline constexpr std::array<std::string_view, 4> kDashes{"", "6 3", "2 2.5", "9 3 2 3"};
inline constexpr std::string_view kTruthColour = "#b8b8b8";
inline constexpr std::string_view kContactColour = "#777";
inline constexpr std::string_view kEventColour = "#8a2b6b";  // differs from all observers' colours
inline constexpr std::string_view kBarColour = "#7d8ca3";    // for bars that stand for no observer and no line

[[nodiscard]] inline std::string_view colour_of(std::size_t i) { return kColours[i % kColours.size()]; }
[[nodiscard]] inline std::string_view dashes_of(std::size_t i) { return kDashes[i % kDashes.size()]; }

// The second observer's line often covers the first's, and dashes let the first show through.
[[nodiscard]] inline Stroke observer_stroke(std::size_t i) {
  return {.colour = colour_of(i), .width = 1.5, .dashes = i == 0 ? "" : "5 4"};
}

struct LegendEntry {
  enum class Mark { kLine, kUpright, kCircle, kDisc, kCross, kSquare, kOutline } mark = Mark::kLine;
  Stroke stroke;
  std::string label;
  std::string_view fill = {};  // of an outline; "": the colour of its stroke
  double fill_opacity = 0.15;
};

// Breaks a legend into as many lines as it takes for every entry to fit.
[[nodiscard]] std::vector<std::vector<LegendEntry>> legend_rows(std::span<const LegendEntry> entries, double width);

// Draws a legend on one line from `at` (the text's baseline) to the right, as far as `width` reaches. Entries that do
// not fit are counted: "+ 3".
void draw_legend(Svg& svg, Point at, double width, std::span<const LegendEntry> entries);

// The end of a text that is too long, because the end of a path tells objects apart.
[[nodiscard]] std::string shortened(const std::string& text, double width, double size);

// Draws a title, smaller where it would not fit.
void draw_title(Svg& svg, Point at, double width, std::string_view title, std::string_view subtitle);

inline constexpr double kBarPitch = 34.0;  // from one bar to the next, where there is room [px]

struct BarEntry {
  std::string label;
  double value = 0.0;
  std::string_view colour;
  std::optional<Stroke> line;  // sample of a line, drawn between label and bar
};

// Draws horizontal bars with their labels at the left, inside `box`. Values are written behind them with `decimals`.
void draw_bars(Svg& svg, const Box& box, std::string_view title, std::span<const BarEntry> bars, int decimals);

// Draws the events of the scenario: vertical lines through all of these panels, which share the time axis, with the
// names at the top of the first panel, below each other where they would touch.
void draw_events(Svg& svg, const measure::RunRecord& run, std::span<const Panel* const> panels);

// The record of an object by its path; null if the run has none.
[[nodiscard]] const measure::ObjectInfo* find_object(const measure::RunRecord& run, std::string_view path);

// The peers other than the owner that have samples of the object, in the record's order.
[[nodiscard]] std::vector<measure::PeerInfo> observers_of(const measure::RunRecord& run,
                                                          const measure::ObjectInfo& object);

[[nodiscard]] inline std::string component_name(int component) { return {"xyz"[component]}; }

// The value of network.latency_ms, which the scales of the pictures depend on. It is empty where runs have none.
[[nodiscard]] std::string latency_text(const measure::RunRecord& run);

// All swept and set parameters in words, or the scenario's name.
[[nodiscard]] std::string run_title(const measure::ScenarioInfo& info, const measure::RunRecord& run);

// The truth of an object at all instants at which any peer has a sample of it. Not every peer receives an object all
// the time.
struct TruthSample {
  double t_s = 0.0;
  Vec3 position = Vec3::Zero();
};
[[nodiscard]] std::vector<TruthSample> truth_of(const measure::RunRecord& run, const measure::ObjectInfo& object);
[[nodiscard]] std::vector<Point> component_over_time(std::span<const TruthSample> truth, int component);

// One observer's ghost of one object, as curves over time.
struct ErrorSeries {
  std::vector<Point> ghost, error;  // component of the position [m] and distance [m]
  double mean_m = 0.0;              // mean of all finite errors, of which the curve may have only some
};
[[nodiscard]] ErrorSeries error_series(const measure::RunRecord& run, PeerId observer, ObjectId object, int component);

// How many updates of the object were sent, of which the record may have only some.
[[nodiscard]] std::uint64_t updates_sent(const measure::RunRecord& run, ObjectId object);

}  // namespace peerd::report
