#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/plan_contents.hpp"
#include "peerd/lab/report/polyline.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

// The picture stays some hundred kilobytes: a point is a dozen bytes.
constexpr std::size_t kPointsMax = 16'000;  // of the paths of all objects but the principal one
constexpr std::size_t kMoversMax = 4'000;   // paths, of which each has two points at least
constexpr double kFinest_px = 0.3;          // how far a line may be from its points; no eye sees it

struct PlanLayout {  // [px]
  static constexpr double kLeft = 70.0;
  static constexpr double kTop = 102.0;
  static constexpr double kWidthMax = 1040.0;
  static constexpr double kHeightMax = 760.0;
  static constexpr double kTextWidth = 760.0;  // at least, for the legends
  static constexpr double kLegendRow = 16.0;
  static constexpr double kBelow = 66.0;  // numbers, the axis, and a line of notes
};

std::size_t worst_run(const nlohmann::ordered_json& summary, const std::string& path) {
  std::size_t worst = 0;
  double worst_m = -1.0;
  const auto& runs = summary.at("runs");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    double sum_m = 0.0;
    for (const auto& row : runs[i].at("objects")) {
      if (row.at("path") == path) sum_m += row.at("ghost_error_m").at("mean").get<double>();
    }
    if (sum_m > worst_m) {
      worst_m = sum_m;
      worst = i;
    }
  }
  return worst;
}

std::string axis_name(int axis, double sign) {
  return std::string(sign < 0.0 ? "−" : "") + (axis == 0 ? "x" : "z") + " [m]";
}

std::string number_of(std::size_t count, const char* what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

// The lines of many objects, in pixels, by the number of their owner's colour.
struct OwnerLines {
  std::map<std::size_t, std::vector<std::vector<Point>>> by_colour;
  double tolerance_px = kFinest_px;  // how far the lines are from their points at most
};

// The drawing of one plan, whose parts are added from the back to the front.
class Plan {
 public:
  Plan(Svg& svg, const measure::RunRecord& run, const measure::ObjectInfo& principal, const PlanContents& contents,
       std::span<const measure::PeerInfo> observers, const PlanFrame& frame)
      : svg_(svg),
        run_(run),
        principal_(principal),
        contents_(contents),
        observers_(observers),
        frame_(frame),
        box_{PlanLayout::kLeft, PlanLayout::kTop, frame.width_px, frame.height_px},
        panel_(box_, frame.across, frame.up) {}

  void draw() {
    draw_scene();
    panel_.draw_axes(svg_, {.x = axis_name(frame_.axes.across, frame_.axes.across_sign),
                            .y = axis_name(frame_.axes.up, frame_.axes.up_sign),
                            .x_ticks = std::clamp(static_cast<int>(box_.width / 65.0), 3, 16),
                            .y_ticks = std::clamp(static_cast<int>(box_.height / 28.0), 3, 16)});
    draw_owned();
    draw_others();
    draw_principal();
    draw_marks();
    const double top = PlanLayout::kTop - 10.0, width = std::max(box_.width, PlanLayout::kTextWidth);
    draw_legend(svg_, {PlanLayout::kLeft, top - PlanLayout::kLegendRow}, width, principal_legend_);
    draw_legend(svg_, {PlanLayout::kLeft, top}, width, legend_);
    std::string notes;
    for (const std::string& note : notes_) notes += (notes.empty() ? "" : "; ") + note;
    if (notes.empty()) return;
    svg_.text({PlanLayout::kLeft, box_.y + box_.height + 54.0}, shortened(notes, width, 11.0),
              {.size = 11.0, .colour = "#666"});
  }

 private:
  // One colour a peer: the observers have those of the other pictures, the owner of the principal object the next one.
  [[nodiscard]] std::size_t colour_number(PeerId peer) const {
    const auto observer = std::ranges::find(observers_, peer, &measure::PeerInfo::peer);
    if (observer != observers_.end()) return static_cast<std::size_t>(observer - observers_.begin());
    if (peer == principal_.owner) return observers_.size();
    const auto at = std::ranges::find(run_.peers, peer, &measure::PeerInfo::peer) - run_.peers.begin();
    return observers_.size() + 1 + static_cast<std::size_t>(at);
  }

  [[nodiscard]] Point in_pixels(const Vec3& p) const {
    const Point at = frame_.axes.of(p);
    return panel_.at(at.x, at.y);
  }
  // The parts of a path that are in the picture. Places that are no numbers interrupt it.
  [[nodiscard]] std::vector<std::vector<Point>> parts_inside(const std::vector<Vec3>& path) const {
    std::vector<std::vector<Point>> parts;
    std::vector<Point> piece;
    for (std::size_t i = 0; i <= path.size(); ++i) {
      if (i < path.size() && path[i].allFinite()) {
        piece.push_back(in_pixels(path[i]));
        continue;
      }
      for (std::vector<Point>& part : clipped_line(piece, box_)) parts.push_back(std::move(part));
      piece.clear();
    }
    return parts;
  }
  [[nodiscard]] bool inside(const Point& p) const {
    return box_.x <= p.x && p.x <= box_.x + box_.width && box_.y <= p.y && p.y <= box_.y + box_.height;
  }
  // False where the outline is outside of the picture.
  bool draw_outline(const measure::SceneOutline& outline, const LegendEntry& style) {
    std::vector<Point> corners;
    for (const auto& corner : outline.corners) corners.push_back(in_pixels(Vec3(corner.x(), 0.0, corner.y())));
    if (corners.empty()) return false;
    const std::vector<Point> inside = clipped_polygon(corners, box_);
    if (inside.empty()) return false;
    if (inside.size() > 2) svg_.polygon(inside, style.fill, style.fill_opacity);
    corners.push_back(corners.front());
    svg_.lines(clipped_line(corners, box_), style.stroke);  // not along the edge of the picture
    return true;
  }

  void draw_scene() {
    using Mark = LegendEntry::Mark;
    const LegendEntry floor{Mark::kOutline, {.colour = "#b8b8b8", .width = 0.8}, "below all paths", kBarColour, 0.07};
    const LegendEntry standing{Mark::kOutline, {.colour = "#777", .width = 0.8}, "what stands", kBarColour, 0.3};
    for (const LegendEntry* const style : {&floor, &standing}) {  // what stands on a floor is drawn over it
      bool any = false;
      for (const measure::SceneOutline* const outline : contents_.scene_outlines) {
        const bool is_floor = outline->top_m <= contents_.lowest_m;
        if (is_floor == (style == &floor)) any |= draw_outline(*outline, *style);
      }
      if (any) legend_.push_back(*style);
    }
    if (run_.outlines_left_out > 0) {
      notes_.push_back(number_of(run_.outlines_left_out, "shape") +
                       " of the scene, farthest from the objects, not drawn");
    }
  }

  void draw_owned() {
    for (const auto& [owner, outline] : contents_.owned_outlines) {
      const std::string_view colour = colour_of(colour_number(owner));
      draw_outline(*outline, {LegendEntry::Mark::kOutline, {.colour = colour, .width = 0.8}, "", colour});
    }
  }

  // The paths of the others, so fine that they have kPointsMax points at most, if two for each do.
  [[nodiscard]] OwnerLines lines_of_others() const {
    std::vector<std::pair<std::size_t, std::vector<Point>>> lines;
    for (const PlanContents::Other& other : std::span(contents_.others).first(drawn_movers())) {
      for (std::vector<Point>& part : parts_inside(other.truth)) {
        lines.emplace_back(colour_number(other.owner), std::move(part));
      }
    }
    OwnerLines result;
    while (true) {
      std::size_t points = 0;
      for (auto& [colour, line] : lines) {
        line = simplified(line, result.tolerance_px);
        points += line.size();
      }
      if (points <= std::max(kPointsMax, 2 * lines.size()) || result.tolerance_px > 100.0) break;
      result.tolerance_px *= 1.5;
    }
    for (auto& [colour, line] : lines) result.by_colour[colour].push_back(std::move(line));
    return result;
  }

  [[nodiscard]] std::size_t drawn_movers() const { return std::min(contents_.moving, kMoversMax); }

  void draw_others() {
    const OwnerLines lines = lines_of_others();
    for (const auto& [colour, of_owner] : lines.by_colour) {
      svg_.lines(of_owner, {.colour = colour_of(colour), .width = 1.0, .opacity = 0.7});
    }
    for (const measure::PeerInfo& peer : run_.peers) add_to_legend(peer);
    if (lines.tolerance_px > 1.0) {
      notes_.push_back("paths drawn to " + short_label(lines.tolerance_px, 2) + " pixels");
    }
    if (contents_.moving > kMoversMax) {
      notes_.push_back("of " + std::to_string(contents_.moving) + " other objects that move, the " +
                       std::to_string(kMoversMax) + " that go farthest");
    }
    if (contents_.unseen > 0)
      notes_.push_back(number_of(contents_.unseen, "object") + " unseen by all other peers, not drawn");
    std::size_t leaving = 0, outside = 0;
    for (const PlanContents::Other& other : contents_.others) {
      const bool leaves =
          std::ranges::any_of(other.truth, [&](const Vec3& p) { return p.allFinite() && !inside(in_pixels(p)); });
      if (leaves) ++(other.moves ? leaving : outside);
    }
    if (leaving > 0) {
      notes_.push_back(number_of(leaving, "path") + (leaving == 1 ? " leads" : " lead") + " out of the picture");
    }
    if (outside > 0) {
      notes_.push_back(number_of(outside, "object") + (outside == 1 ? " stands" : " stand") +
                       " outside of the picture");
    }
  }

  void add_to_legend(const measure::PeerInfo& peer) {
    using Mark = LegendEntry::Mark;
    std::size_t moving = 0, standing = 0;
    for (const PlanContents::Other& other : contents_.others) {
      if (other.owner == peer.peer) ++(other.moves ? moving : standing);
    }
    if (moving + standing == 0) return;
    std::string label = (peer.peer == principal_.owner ? "others of " : "of ") + peer.name + ": ";
    if (moving > 0) label += std::to_string(moving) + " moving";
    if (standing > 0) label += (moving > 0 ? ", " : "") + std::to_string(standing) + " standing";
    const Stroke stroke{.colour = colour_of(colour_number(peer.peer)), .width = 1.0};
    legend_.push_back({moving > 0 ? Mark::kLine : Mark::kOutline, stroke, std::move(label)});
  }

  void draw_principal() {
    using Mark = LegendEntry::Mark;
    const Stroke truth{.colour = kTruthColour, .width = 5.0};
    principal_legend_ = {{Mark::kLine, truth, "truth of " + shortened(principal_.path, 300.0, 11.0)}};
    const auto draw_path = [&](const std::vector<Vec3>& path, const Stroke& stroke) {
      for (const auto& part : parts_inside(path)) {
        svg_.polyline(simplified(part, 0.5 * kFinest_px), stroke);
      }
    };
    draw_path(contents_.truth, truth);
    for (std::size_t i = 0; i < observers_.size(); ++i) {
      draw_path(contents_.ghosts[i], observer_stroke(i));
      principal_legend_.push_back({Mark::kLine, observer_stroke(i), "ghost at " + observers_[i].name});
    }
  }

  void draw_marks() {
    constexpr std::size_t kMarksMax = 400;
    const std::size_t count = std::min(contents_.without_outline.size(), kMarksMax);
    for (const Vec3& place : std::span(contents_.without_outline).first(count)) {
      const Point at = in_pixels(place);
      if (inside(at)) svg_.rect({at.x - 3.5, at.y - 3.5, 7.0, 7.0}, "#444");
    }
    if (count > 0) legend_.push_back({LegendEntry::Mark::kSquare, {.colour = "#444"}, "other objects at the start"});
  }

  Svg& svg_;
  const measure::RunRecord& run_;
  const measure::ObjectInfo& principal_;
  const PlanContents& contents_;
  std::span<const measure::PeerInfo> observers_;
  const PlanFrame& frame_;
  Box box_;
  Panel panel_;
  std::vector<LegendEntry> principal_legend_, legend_;
  std::vector<std::string> notes_;
};

}  // namespace

std::string plan_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                        const nlohmann::ordered_json& summary) {
  const std::string path = principal_object(summary);
  const std::size_t number = worst_run(summary, path);
  const measure::ObjectInfo* object = number < runs.size() ? find_object(runs[number], path) : nullptr;
  const std::vector<measure::PeerInfo> observers =
      object ? observers_of(runs[number], *object) : std::vector<measure::PeerInfo>{};
  if (observers.empty()) {
    Svg svg(800.0, 80.0);
    draw_title(svg, {70.0, 28.0}, 700.0, info.name, "no object that another peer observes");
    return std::move(svg).finish();
  }
  const measure::RunRecord& run = runs[number];
  const PlanContents contents = plan_contents(run, *object, observers);
  const PlanFrame frame = plan_frame(contents, PlanLayout::kWidthMax, PlanLayout::kHeightMax);
  const double width = std::max(frame.width_px, PlanLayout::kTextWidth);

  Svg svg(width + PlanLayout::kLeft + 20.0, frame.height_px + PlanLayout::kTop + PlanLayout::kBelow);
  std::vector<std::string> keys;
  for (const auto& item : run.params.items()) keys.push_back(item.key());
  draw_title(svg, {PlanLayout::kLeft, 28.0}, width,
             info.name + " from above" + (keys.empty() ? "" : ": " + measure::describe(run.params, keys)),
             object->path + ", run " + std::to_string(number + 1) +
                 (runs.size() > 1 ? ", the one with the greatest mean ghost error" : "") +
                 (frame.axes.turned() ? "; turned by 90 degrees: −z points right" : ""));
  Plan(svg, run, *object, contents, observers, frame).draw();
  return std::move(svg).finish();
}

}  // namespace peerd::report
