#include "peerd/lab/report/plan_contents.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "core/box.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/report/figure_parts.hpp"

namespace peerd::report {
namespace {

// An object that moves by less has only been rounded or pushed by another's rounding.
constexpr double kStill_m = 1e-6;
const Vec3 kNoPlace = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());

// Whether a picture can have the place: Range ignores what is as far as this.
bool is_place(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < 1e100; }

// The places of a path in order of time, with a place that is no number where it has a gap: nobody had a sample for a
// long time, and a line across would say that somebody did.
std::vector<Vec3> with_gaps(const std::vector<TruthSample>& samples) {
  constexpr double kShortest_s = 0.25, kSteps = 8.0;
  std::vector<Vec3> path;
  if (samples.empty()) return path;
  const double step_s = (samples.back().t_s - samples.front().t_s) / static_cast<double>(samples.size());
  const double gap_s = std::max(kShortest_s, kSteps * step_s);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0 && samples[i].t_s - samples[i - 1].t_s > gap_s) {
      path.push_back(kNoPlace);
    }
    path.push_back(samples[i].position);
  }
  return path;
}

std::vector<Vec3> truth_path(const measure::RunRecord& run, const measure::ObjectInfo& object) {
  std::vector<TruthSample> samples = truth_of(run, object);
  std::erase_if(samples, [](const TruthSample& s) { return !is_place(s.position); });
  return with_gaps(samples);
}

std::vector<Vec3> ghost_path(const measure::RunRecord& run, PeerId observer, ObjectId object) {
  std::vector<TruthSample> samples;
  for (const measure::GhostSample& s : measure::ghost_samples_of(run, observer, object)) {
    samples.push_back({s.t_s, is_place(s.ghost.position) ? s.ghost.position : kNoPlace});
  }
  return with_gaps(samples);
}

double extent_m(const std::vector<Vec3>& path) {
  WorldBox box;
  for (const Vec3& p : path) box.merge(p);
  return (box.hi - box.lo).maxCoeff();
}

void add_others(PlanContents& contents, const measure::RunRecord& run, const measure::ObjectInfo& principal) {
  struct Found {
    double extent_m;
    PlanContents::Other other;
    bool outlined;
  };
  std::set<ObjectId> outlined;
  for (const measure::SceneOutline& outline : run.outlines) {
    if (outline.owned) outlined.insert(*outline.owned);
  }
  std::vector<Found> found;
  for (const measure::ObjectInfo& object : run.objects) {
    if (object.object == principal.object) continue;
    std::vector<Vec3> truth = truth_path(run, object);
    if (truth.empty()) {
      ++contents.unseen;
      continue;
    }
    const double extent = extent_m(truth);
    const bool moves = extent > kStill_m;
    if (!moves) truth.resize(1);
    contents.moving += moves ? 1 : 0;
    found.push_back({moves ? extent : 0.0, {object.owner, std::move(truth), moves}, outlined.contains(object.object)});
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &Found::extent_m);
  for (Found& f : found) contents.others.push_back(std::move(f.other));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const PlanContents::Other& other = contents.others[i];
    if (!other.moves && !found[i].outlined) contents.without_outline.push_back(other.truth.front());
  }
}

// A rectangle of the world's x and z [m].
struct Ground {
  Range x, z;
  void add(const Vec3& p) { (x.add(p.x()), z.add(p.z())); }
  void add(const Ground& other) {
    for (const double v : {other.x.lo, other.x.hi}) x.add(v);
    for (const double v : {other.z.lo, other.z.hi}) z.add(v);
  }
  [[nodiscard]] double longer() const { return std::max(x.hi - x.lo, z.hi - z.lo); }
  [[nodiscard]] Ground grown(double by) const { return {{x.lo - by, x.hi + by}, {z.lo - by, z.hi + by}}; }
  [[nodiscard]] Ground within(const Ground& other) const {
    return {{std::max(x.lo, other.x.lo), std::min(x.hi, other.x.hi)},
            {std::max(z.lo, other.z.lo), std::min(z.hi, other.z.hi)}};
  }
  [[nodiscard]] bool empty() const { return x.empty() || z.empty(); }
  [[nodiscard]] bool contains(const Ground& other) const {
    return x.lo <= other.x.lo && other.x.hi <= x.hi && z.lo <= other.z.lo && other.z.hi <= z.hi;
  }
};

// The range without the lowest and the highest tenth of the values, and a quarter of it more on either side. It holds
// all values that are spread evenly, and all of less than ten.
Range usual(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const std::size_t cut = values.size() / 10;
  const double lo = values[cut], hi = values[values.size() - 1 - cut], room = 0.25 * (hi - lo);
  return {lo - room, hi + room};
}

// The ground of all paths, but for what a few of the others have far off.
Ground ground_of_paths(const PlanContents& contents) {
  Ground ground, others;
  for (const Vec3& p : contents.truth) ground.add(p);
  std::vector<double> x, z;  // the ends of each path
  for (const PlanContents::Other& other : std::span(contents.others).first(contents.moving)) {
    Ground path;
    for (const Vec3& p : other.truth) path.add(p);
    others.add(path);
    x.insert(x.end(), {path.x.lo, path.x.hi});
    z.insert(z.end(), {path.z.lo, path.z.hi});
  }
  if (!others.empty()) {
    const Ground near = others.within({usual(std::move(x)), usual(std::move(z))});
    if (!near.empty()) ground.add(near);
  }
  if (ground.empty()) return {{0.0, 1.0}, {0.0, 1.0}};
  Ground ghosts;
  for (const auto& ghost : contents.ghosts) {
    for (const Vec3& p : ghost) ghosts.add(p);
  }
  const Ground near = ghosts.within(ground.grown(0.5 * ground.longer()));
  if (!near.empty()) ground.add(near);
  return ground;
}

// How far the frame reaches towards an object, as shares of the longer extent of the paths.
constexpr double kNear = 0.2;       // scene farther away is left out
constexpr double kOwnedNear = 0.5;  // so are owned objects
constexpr double kWhole = 0.25;     // an object within this is shown as a whole
constexpr double kPart = 0.05;      // and otherwise so much of it

// The part of an object along one axis that the frame is to show: a little beyond the paths, or its near side.
Range part_of(const Range& object, const Range& paths, double near, double longer) {
  const double lo_room = object.hi < paths.lo ? near + kPart : kPart;
  const double hi_room = object.lo > paths.hi ? near + kPart : kPart;
  return {std::max(object.lo, paths.lo - lo_room * longer), std::min(object.hi, paths.hi + hi_room * longer)};
}

// The ground with what stands near: whole where it is small, else a part of it.
Ground with_surroundings(const PlanContents& contents, const Ground& paths) {
  const double longer = paths.longer() > 0.0 ? paths.longer() : 1.0;
  Ground ground = paths;
  const auto add = [&](const Ground& object, double near) {
    if (object.empty() || object.within(paths.grown(near * longer)).empty()) return;
    const bool whole = paths.grown(std::max(near, kWhole) * longer).contains(object);
    ground.add(whole ? object
                     : Ground{part_of(object.x, paths.x, near, longer), part_of(object.z, paths.z, near, longer)});
  };
  const auto ground_of = [](const measure::SceneOutline& outline) {
    Ground object;
    for (const auto& corner : outline.corners) object.add(Vec3(corner.x(), 0.0, corner.y()));
    return object;
  };
  for (const measure::SceneOutline* outline : contents.scene_outlines) add(ground_of(*outline), kNear);
  for (const auto& [owner, outline] : contents.owned_outlines) add(ground_of(*outline), kOwnedNear);
  for (const Vec3& place : contents.without_outline) {
    Ground object;
    object.add(place);
    add(object, kOwnedNear);
  }
  return ground;
}

}  // namespace

PlanFrame plan_frame(const PlanContents& contents, double width_max_px, double height_max_px) {
  constexpr double kShortest = 0.06;     // least ratio of the sides, for paths that are nearly straight
  constexpr double kTurnedBeyond = 2.0;  // ratio of the extents along z and x
  Ground ground = with_surroundings(contents, ground_of_paths(contents));
  ground = ground.grown(0.02 * ground.longer());
  const double longer = std::max(ground.longer(), 1e-3);
  for (Range* const range : {&ground.x, &ground.z}) {
    const double lacks = kShortest * longer - (range->hi - range->lo);
    if (lacks > 0.0) *range = {range->lo - 0.5 * lacks, range->hi + 0.5 * lacks};
  }
  PlanFrame frame;
  if (ground.z.hi - ground.z.lo > kTurnedBeyond * (ground.x.hi - ground.x.lo)) frame.axes = {2, 0, -1.0, -1.0};
  for (const double x : {ground.x.lo, ground.x.hi}) {
    for (const double z : {ground.z.lo, ground.z.hi}) {
      const Point p = frame.axes.of({x, 0.0, z});
      frame.across.add(p.x);
      frame.up.add(p.y);
    }
  }
  const double across_m = frame.across.hi - frame.across.lo, up_m = frame.up.hi - frame.up.lo;
  const double px_per_m = std::min(width_max_px / across_m, height_max_px / up_m);
  frame.width_px = px_per_m * across_m;
  frame.height_px = px_per_m * up_m;
  return frame;
}

PlanContents plan_contents(const measure::RunRecord& run, const measure::ObjectInfo& principal,
                           std::span<const measure::PeerInfo> observers) {
  PlanContents contents;
  contents.truth = truth_path(run, principal);
  for (const measure::PeerInfo& observer : observers) {
    contents.ghosts.push_back(ghost_path(run, observer.peer, principal.object));
  }
  add_others(contents, run, principal);
  for (const measure::SceneOutline& outline : run.outlines) {
    const auto object =
        std::ranges::find(run.objects, outline.owned.value_or(ObjectId{}), &measure::ObjectInfo::object);
    if (outline.owned && object != run.objects.end()) {
      contents.owned_outlines.emplace_back(object->owner, &outline);
    } else {
      contents.scene_outlines.push_back(&outline);
    }
  }
  contents.lowest_m = std::numeric_limits<double>::infinity();
  for (const Vec3& p : contents.truth) contents.lowest_m = std::min(contents.lowest_m, p.y());
  for (const PlanContents::Other& other : contents.others) {
    for (const Vec3& p : other.truth) contents.lowest_m = std::min(contents.lowest_m, p.y());
  }
  return contents;
}

}  // namespace peerd::report
