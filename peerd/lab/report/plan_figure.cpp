#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

// The figure stays some hundred kilobytes: a point is a dozen bytes.
constexpr std::size_t kPointsMax = 16'000;  // of the paths of all objects but the principal one
constexpr std::size_t kMoversMax = 4'000;   // paths, of which each has two points at least
constexpr std::size_t kMarksMax = 400;
constexpr double kFinest = 3e-4;   // how far a line may be from its points, as a share of its extent
constexpr double kStill_m = 1e-6;  // an object that moves by less has only been rounded or pushed by rounding

using Path = std::vector<Point>;  // world x and z [m], interrupted by places that are no numbers

// The distance of p from the segment from a to b.
double distance_from(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double along = length2 > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

// The points of a path of which no point is farther than the tolerance from the line through the points that are kept
// (Douglas and Peucker, The Canadian Cartographer 10(2), 1973). The places that are no numbers are kept.
Path simplified(const Path& path, double tolerance_m) {
  Path kept;
  std::vector<std::size_t> ends;  // of what is still to be simplified, the nearest one last
  for (std::size_t first = 0; first < path.size(); ++first) {
    kept.push_back(path[first]);
    if (std::isnan(path[first].x)) continue;
    ends = {first};
    while (ends[0] + 1 < path.size() && !std::isnan(path[ends[0] + 1].x)) ++ends[0];
    while (!ends.empty()) {
      double farthest = tolerance_m;
      std::size_t at = first;
      for (std::size_t i = first + 1; i < ends.back(); ++i) {
        const double distance = distance_from(path[i], path[first], path[ends.back()]);
        if (distance > farthest) farthest = distance, at = i;
      }
      if (at != first) {
        ends.push_back(at);
        continue;
      }
      if (ends.back() != first) kept.push_back(path[ends.back()]);
      first = ends.back();
      ends.pop_back();
    }
  }
  return kept;
}

// An object other than the principal one.
struct Other {
  const measure::ObjectInfo* object = nullptr;
  Path path;              // not empty; one place of what stands still
  double extent_m = 0.0;  // 0: it stands still
};

// Makes the series of one plan, from the back to the front.
class Plan {
 public:
  Plan(const measure::RunRecord& run, const measure::ObjectInfo& principal)
      : run_(run), principal_(principal), observers_(observers_of(run, principal)) {
    truth_ = path_of(truth_of(run, principal), true);
    for (const measure::ObjectInfo& object : run.objects) {
      if (object.object == principal.object) continue;
      Other other{&object, {}};
      const std::vector<PathPoint> truth = truth_of(run, object);
      other.path = path_of(truth, true);
      for (int c = 0; c < 3; ++c) {
        Range range;
        for (const PathPoint& p : truth) range.add(p.position[c]);
        if (range.width() > kStill_m) other.extent_m = std::max(other.extent_m, range.width());
      }
      if (other.path.empty()) {
        ++unseen_;
        continue;
      }
      if (other.extent_m == 0.0) other.path.resize(1);
      others_.push_back(std::move(other));
    }
    std::ranges::stable_sort(others_, std::ranges::greater{}, &Other::extent_m);
    moving_ = static_cast<std::size_t>(std::ranges::count_if(others_, [](const Other& o) { return o.extent_m > 0.0; }));
  }

  [[nodiscard]] Json series() {
    add_outlines();
    add_others();
    const std::string truth = "truth of " + principal_.path;
    add(truth_, {{"name", truth}, {"role", "truth"}, {"colour", "truth"}, {"width", 5}, {"legend", truth}});
    for (std::size_t i = 0; i < observers_.size(); ++i) {
      add(path_of(ghost_of(run_, observers_[i].peer, principal_.object), false),
          {{"name", "ghost at " + observers_[i].name},
           {"role", "ghost"},
           {"colour", i},
           {"dash", i == 0 ? 0 : 1 + i / 6 % 3}});
    }
    add_marks();
    return series_;
  }

  // What is not in the figure.
  [[nodiscard]] Json notes() const {
    Json notes = Json::array();
    const auto note = [&](std::size_t count, const char* one, const char* more) {
      if (count > 0) notes.push_back(std::to_string(count) + (count == 1 ? one : more));
    };
    note(run_.outlines_left_out, " shape of the scene, farthest from the objects, not drawn",
         " shapes of the scene, farthest from the objects, not drawn");
    if (tolerance_ > 1e-3)
      notes.push_back("paths drawn to " + digits_text(100.0 * tolerance_, 2) + " % of their extent");
    if (moving_ > kMoversMax) {
      notes.push_back("of " + std::to_string(moving_) + " other objects that move, the " + std::to_string(kMoversMax) +
                      " that go farthest");
    }
    note(unseen_, " object unseen by all other peers, not drawn", " objects unseen by all other peers, not drawn");
    return notes;
  }

 private:
  Path path_of(const std::vector<PathPoint>& points, bool truth) {
    Path path;
    for (const PathPoint& p : points) {
      const bool place = drawable(p.position.x()) && drawable(p.position.y()) && drawable(p.position.z());
      if (place && truth) lowest_m_ = std::fmin(lowest_m_, p.position.y());
      if (place) path.push_back({p.position.x(), p.position.z()});
      if (!place && !path.empty() && drawable(path.back().x)) path.push_back({std::nan(""), std::nan("")});
    }
    return path;
  }

  // One colour a peer: the observers have those of the other figures, the owner of the principal object the next one.
  [[nodiscard]] std::size_t colour_of(PeerId peer) const {
    const auto observer = std::ranges::find(observers_, peer, &measure::PeerInfo::peer);
    if (observer != observers_.end()) return static_cast<std::size_t>(observer - observers_.begin());
    if (peer == principal_.owner) return observers_.size();
    const auto at = std::ranges::find(run_.peers, peer, &measure::PeerInfo::peer) - run_.peers.begin();
    return observers_.size() + 1 + static_cast<std::size_t>(at);
  }

  void add(const Path& path, Json look) {
    Range x, z;
    for (const Point& p : path) (x.add(p.x), z.add(p.y));
    series_.push_back(curve(simplified(path, kFinest * std::max(x.width(), z.width())), std::move(look)));
  }

  void add_outlines() {
    Json floor = Json::array(), standing = Json::array(), own = Json::array();
    for (const measure::SceneOutline& outline : run_.outlines) {
      std::vector<double> corners;
      for (const auto& corner : outline.corners) corners.insert(corners.end(), {corner.x(), corner.y()});
      const auto object =
          std::ranges::find(run_.objects, outline.owned.value_or(ObjectId{}), &measure::ObjectInfo::object);
      const bool owned = outline.owned && object != run_.objects.end();
      Json& list = owned && object->object == principal_.object ? own
                   : owned                                      ? outlines_[object->owner]
                   : outline.top_m <= lowest_m_                 ? floor
                                                                : standing;
      list.push_back(numbers(corners));
    }
    const auto polygons = [&](const std::string& name, const char* role, const Json& colour, double opacity,
                              const Json& list) {
      if (list.empty()) return;
      series_.push_back({{"name", name}, {"role", role}, {"colour", colour}, {"opacity", opacity}, {"polygons", list}});
    };
    polygons("below all paths", "scene", "bar", 0.07, floor);
    polygons("what stands", "scene", "bar", 0.3, standing);
    polygons("truth of " + principal_.path, "owned", colour_of(principal_.owner), 0.15, own);
  }

  // The paths of the others, so fine that they have kPointsMax points at most, if two for each do.
  void add_others() {
    while (true) {
      std::size_t points = 0;
      for (Other& other : others_) points += (other.path = simplified(other.path, tolerance_ * other.extent_m)).size();
      if (points <= std::max(kPointsMax, 4 * moving_)) break;
      tolerance_ *= 1.5;
    }
    for (const measure::PeerInfo& peer : run_.peers) {
      Path paths;
      std::size_t moving = 0, standing = 0;
      for (std::size_t i = 0; i < others_.size(); ++i) {
        if (others_[i].object->owner != peer.peer) continue;
        ++(others_[i].extent_m > 0.0 ? moving : standing);
        if (others_[i].extent_m == 0.0 || i >= kMoversMax) continue;
        paths.insert(paths.end(), others_[i].path.begin(), others_[i].path.end());
        paths.push_back({std::nan(""), std::nan("")});
      }
      if (moving + standing == 0) continue;
      const std::string name = (peer.peer == principal_.owner ? "others of " : "of ") + peer.name;
      std::string legend = name + ':';
      if (moving > 0) legend += ' ' + std::to_string(moving) + " moving";
      if (standing > 0) legend += (moving > 0 ? ", " : " ") + std::to_string(standing) + " standing";
      const Json look{{"name", name}, {"colour", colour_of(peer.peer)}, {"legend", legend}};
      Json shapes = look;
      if (moving > 0) shapes.erase("legend");
      shapes.update({{"role", "owned"}, {"opacity", 0.15}, {"polygons", Json::array()}});
      if (outlines_.contains(peer.peer)) shapes["polygons"] = outlines_[peer.peer];
      series_.push_back(std::move(shapes));
      if (paths.empty()) continue;
      series_.push_back(curve(paths, look));
      series_.back().update({{"role", "path"}, {"width", 1}, {"opacity", 0.7}});
    }
  }

  void add_marks() {
    std::set<ObjectId> outlined;
    for (const measure::SceneOutline& o : run_.outlines) outlined.insert(o.owned.value_or(ObjectId{}));
    Path marks;
    for (const Other& other : others_) {
      if (other.extent_m == 0.0 && !outlined.contains(other.object->object) && marks.size() < kMarksMax)
        marks.push_back(other.path.front());
    }
    if (marks.empty()) return;
    series_.push_back(curve(marks, {{"name", "other objects at the start"},
                                    {"role", "mark"},
                                    {"colour", "ink"},
                                    {"mark", "square"},
                                    {"line", false}}));
  }

  const measure::RunRecord& run_;
  const measure::ObjectInfo& principal_;
  const std::vector<measure::PeerInfo> observers_;
  Path truth_;
  std::vector<Other> others_;                                  // by the extent of their paths
  std::size_t moving_ = 0;                                     // how many others move
  std::size_t unseen_ = 0;                                     // objects without a sample: no peer observes them
  double lowest_m_ = std::numeric_limits<double>::infinity();  // along world y, of all true places
  double tolerance_ = kFinest;       // how far the others' lines are from their points, as a share of their extents
  std::map<PeerId, Json> outlines_;  // of objects other than the principal one
  Json series_ = Json::array();
};

std::size_t worst_run(const Json& summary, const std::string& path) {
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

}  // namespace

Json plan_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs, const Json& summary) {
  const std::string path = principal_object(summary);
  const std::size_t number = worst_run(summary, path);
  const measure::ObjectInfo* object = number < runs.size() ? find_object(runs[number], path) : nullptr;
  if (object == nullptr) return figure_of(info.name, "no object that another peer observes", Json::array());
  const measure::RunRecord& run = runs[number];
  Plan plan(run, *object);
  std::vector<std::string> keys;
  for (const auto& item : run.params.items()) keys.push_back(item.key());
  Json figure{{"kind", "plan"},
              {"title", info.name + " from above" + (keys.empty() ? "" : ": " + measure::describe(run.params, keys))},
              {"subtitle", object->path + ", run " + std::to_string(number + 1) +
                               (runs.size() > 1 ? ", the one with the greatest mean ghost error" : "")},
              {"width", 1040}};
  figure["series"] = plan.series();
  figure["notes"] = plan.notes();
  return figure;
}

}  // namespace peerd::report
