// Question: what does a whole scene's collision detection cost a tick, of what is it made, and how does it grow?
//
// scene_collisions_bench [--quick] [--out DIR] [--commit NAME] [FILE..]: objects go round on circles and turn, at up to
// 1.5 m/s and 1 rad/s, 60 ticks a second; each has an interest in all whose boxes may come to overlap its own. Their
// density is such that ten pairs of boxes an object overlap at the start (`contacts`: others). Objects are OBJ or OFF
// files, or six of PEERD_CORPUS, or generated ones of 1,000 triangles; all of bounding radius 1 m. A tick is timed from
// the first moved Transform to the events, in the thread's own time; what it consists of is measured beside it, by
// doing it alone:
//   placing  a SceneQuery is told what moved and asked for all moved objects' boxes
//   broad    a BroadPhase is told these boxes and ticks
//   narrow   the rest
// Worlds: `all` objects move; `slow`, a tenth as fast; `tenth`, one in ten; `still`, none. `plain`: what there was
// before, SceneQuery::place() and each near pair asked. `forgetful` remembers nothing of pairs; `witnesses` and `gaps`
// one thing. `polygons`: all pairs of polygons that touch are asked for, too. Exit code 1: an answer differs from a new
// SceneQuery's.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "collision/scene/collision_watch.hpp"
#include "collision_meshes.hpp"
#include "core/geometry/mesh.hpp"
#include "core/kinematics.hpp"
#include "figures.hpp"
#include "fitted_exponent.hpp"
#include "heap_meter.hpp"

namespace peerd::bench {
namespace {

using namespace collision;

constexpr double kTick_s = 1.0 / 60.0;

// The time is this thread's CPU time [us]: what else runs here doesn't count.
double thread_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

FaceSetGeometry geometry_of(const TriangleSoup& soup) {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::int32_t> corners;
  for (const Vec3& v : soup.vertices) points.push_back(v.cast<float>());
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t c : face.corners) corners.push_back(static_cast<std::int32_t>(c));
    corners.push_back(Mesh::kEndOfPolygon);
  }
  FaceSetGeometry out;
  out.points = std::move(points);
  out.corners = std::move(corners);
  return out;
}

struct Setting {
  std::size_t objects = 1000;
  double close_pairs = 10.0;  // an object, at the start
  std::size_t moving = 1;     // one in so many; 0: none
  double speed = 1.0;         // times 1.5 m/s and 1 rad/s, at most
  CollisionType type = CollisionType::kWitness;
};

// Transforms with a Shape each, and where they are at a time.
class World {
 public:
  World(const Setting& setting, const std::vector<NamedSoup>& soups) {
    std::mt19937_64 random(42);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (const NamedSoup& named : soups) scene.geometries.emplace_back(geometry_of(named.soup));
    for (std::size_t i = 0; i < setting.objects; ++i) {
      Path& path = paths_.emplace_back();
      path.home = Vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1));
      path.radius_m = uniform(0.2, 1.0);
      path.turn = setting.speed * uniform(0.2, 1.5) / path.radius_m * kTick_s;
      path.phase = uniform(0.0, 2.0 * std::numbers::pi);
      path.spin = Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * setting.speed / std::sqrt(3.0) * kTick_s;
      const auto transform = static_cast<std::uint32_t>(2 * i);
      Instance group, shape;
      group.kind = NodeKind::kTransform;
      group.transform = static_cast<std::uint32_t>(i);
      group.child_index = static_cast<std::uint32_t>(i);
      group.subtree_end = transform + 2;
      shape.kind = NodeKind::kShape;
      shape.geometry = static_cast<std::uint32_t>(i % soups.size());
      shape.parent = static_cast<std::int32_t>(transform);
      shape.subtree_end = transform + 2;
      scene.instances.push_back(group);
      scene.instances.push_back(shape);
      if (setting.moving != 0 && i % setting.moving == 0) moving.push_back(static_cast<std::uint32_t>(i));
    }
    transforms.resize(setting.objects);
    spread(setting.close_pairs * static_cast<double>(setting.objects));
    scene.transforms = transforms;
    for (std::uint32_t a = 0; a < setting.objects; ++a) {
      CollisionInterest interest;
      interest.colliders.ends = {ObjectId{2 * a}};
      interest.type = setting.type;
      std::vector<ObjectId>& collidees = interest.collidees.ends;
      for (std::uint32_t b = a + 1; b < setting.objects; ++b) {
        const Vec3 between = side_m_ * (paths_[b].home - paths_[a].home);
        // No two points of the two ever are nearer than that.
        if (between.norm() <= paths_[a].radius_m + paths_[b].radius_m + 2.0) collidees.push_back(ObjectId{2 * b});
      }
      interest.colliders.named = 1;
      interest.collidees.named = collidees.size();
      pairs += collidees.size();
      if (!collidees.empty()) scene.interests.push_back(std::move(interest));
    }
  }
  void go_to(int tick) {
    for (const std::uint32_t i : moving) put(i, tick);
  }

  Scene scene;
  std::vector<TransformFields> transforms;
  std::vector<std::uint32_t> moving;
  std::size_t pairs = 0;

 private:
  struct Path {
    Vec3 home;  // in the unit cube
    double radius_m, turn, phase;
    Vec3 spin;  // turn, spin: radians a tick
  };
  void put(std::size_t i, int tick) {
    const Path& path = paths_[i];
    const double angle = path.phase + path.turn * tick;
    transforms[i].translation =
        side_m_ * path.home + path.radius_m * Vec3(std::cos(angle), 0.3 * std::sin(2.0 * angle), std::sin(angle));
    transforms[i].rotation = quat_exp(path.spin * (tick + 600.0 * path.phase));
  }
  [[nodiscard]] double overlapping() {
    for (std::size_t i = 0; i < paths_.size(); ++i) put(i, 0);
    SceneQuery query(scene_at());
    std::vector<WorldBox> boxes;
    for (std::uint32_t i = 0; i < paths_.size(); ++i) boxes.push_back(query.box(ObjectId{2 * i}));
    std::size_t count = 0;
    for (std::size_t a = 0; a < boxes.size(); ++a) {
      for (std::size_t b = a + 1; b < boxes.size(); ++b) {
        count +=
            (boxes[a].lo.array() <= boxes[b].hi.array()).all() && (boxes[b].lo.array() <= boxes[a].hi.array()).all();
      }
    }
    return static_cast<double>(count);
  }
  const Scene& scene_at() {
    scene.transforms = transforms;
    return scene;
  }
  // Finds the side of the cube in which so many boxes overlap.
  void spread(double wanted) {
    double low = 1.0, high = 10.0 * std::cbrt(static_cast<double>(paths_.size()));
    for (int i = 0; i < 16; ++i) {
      side_m_ = 0.5 * (low + high);
      (overlapping() > wanted ? low : high) = side_m_;
    }
    side_m_ = high;
    (void)overlapping();
  }
  std::vector<Path> paths_;
  double side_m_ = 1.0;
};

struct Run {
  Quartiles tick, placing, broad;
  double near = 0, colliding = 0, polygons = 0;  // a tick
  double allocations = 0;                        // a tick
  CollisionWatchCounters counters;               // of the timed ticks
  int ticks = 0;
  [[nodiscard]] double per_tick(std::uint64_t count) const { return static_cast<double>(count) / ticks; }
  [[nodiscard]] double narrow() const { return std::max(0.0, tick.median - placing.median - broad.median); }
};

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

class Bench : public Report {
 public:
  explicit Bench(const Options& options) : Report(options) {}

  [[nodiscard]] Run run(const std::string& name, const Setting& setting, const std::vector<NamedSoup>& soups,
                        const CoherenceOptions& coherence, bool ask_for_polygons = false, bool checked = true) {
    World world(setting, soups);
    const int warm_up = options_.quick ? 5 : 60, ticks = options_.quick ? 12 : setting.objects > 1000 ? 60 : 120;
    CollisionWatch watch(world.scene, nullptr, coherence);
    Run out;
    std::vector<double> tick_us;
    tick_us.reserve(static_cast<std::size_t>(ticks));
    std::size_t colliding = 0, polygons = 0, allocations = 0;
    CollisionWatchCounters first;
    for (int tick = 0; tick < warm_up + ticks; ++tick) {
      if (tick == warm_up) first = watch.counters();
      world.go_to(tick);
      const bool timed = tick >= warm_up;
      const HeapMeter meter;
      const double start = thread_us();
      for (const std::uint32_t i : world.moving) watch.move(i, world.transforms[i]);
      const CollisionWatch::Tick& answer = watch.tick();
      if (ask_for_polygons) {
        for (const std::uint32_t i : answer.colliding) polygons += timed ? watch.collision(i).pairs.size() : 0;
      }
      if (timed) {
        tick_us.push_back(thread_us() - start);
        allocations += meter.allocations();
        colliding += answer.colliding.size();
      }
      if (checked && (tick == 0 || tick == warm_up + ticks / 2 || tick == warm_up + ticks - 1)) {
        check(name, world, watch, answer, ask_for_polygons);
      }
    }
    out.tick = quartiles(std::move(tick_us));
    out.counters = watch.counters();
    subtract(out.counters, first);
    out.colliding = static_cast<double>(colliding) / ticks;
    out.polygons = static_cast<double>(polygons) / ticks;
    out.allocations = static_cast<double>(allocations) / ticks;
    out.near =
        static_cast<double>(out.counters.pairs_queried + out.counters.pairs_separated + out.counters.pairs_unmoved) /
        ticks;
    out.ticks = ticks;
    measure_phases(world, warm_up, ticks, out);
    return out;
  }

  // The plain way is the reference: everything is placed, boxes of all interests are compared, and each near pair is
  // asked.
  [[nodiscard]] Quartiles plain(const Setting& setting, const std::vector<NamedSoup>& soups) {
    World world(setting, soups);
    SceneQuery query(world.scene);
    const int ticks = options_.quick ? 3 : 12;
    std::vector<double> us;
    std::size_t colliding = 0;
    for (int tick = 0; tick < 2 + ticks; ++tick) {
      world.go_to(50 + tick);
      const double start = thread_us();
      query.set_transforms(world.transforms);
      for (const CollisionInterest& interest : world.scene.interests) {
        for (const ObjectId collidee : interest.collidees.ends) {
          colliding += query.collide(interest.colliders.ends.front(), collidee, interest.type)->colliding;
        }
      }
      if (tick >= 2) us.push_back(thread_us() - start);
    }
    if (colliding == 0) std::printf("nothing collides\n");
    return quartiles(std::move(us));
  }

  void report(const std::string& name, const Run& run, const std::string& against = {}, double reference = 0.0) {
    const CollisionWatchCounters& c = run.counters;
    const std::uint64_t all = c.pairs_far + c.pairs_unmoved + c.pairs_separated + c.pairs_queried;
    const std::uint64_t near = all - c.pairs_far, shapes = c.shapes.pairs_witnessed + c.shapes.pairs_tested;
    std::printf(
        "%-22s %9.0f us [%.0f %.0f] placing %.0f broad %.0f narrow %.0f | near %.0f colliding %.0f polygons %.0f | far "
        "%.3f; of near: unmoved %.3f separated %.3f asked %.3f | witnessed %.0f tested %.0f gaps %.0f of %.0f | %.1f "
        "allocations\n",
        name.c_str(), run.tick.median, run.tick.low, run.tick.high, run.placing.median, run.broad.median, run.narrow(),
        run.near, run.colliding, run.polygons, share(c.pairs_far, all), share(c.pairs_unmoved, near),
        share(c.pairs_separated, near), share(c.pairs_queried, near), run.per_tick(c.shapes.pairs_witnessed),
        run.per_tick(c.shapes.pairs_tested), run.per_tick(c.gaps_found), run.per_tick(c.gap_searches), run.allocations);
    std::fflush(stdout);
    const auto ratio = reference > 0.0 ? std::optional(run.tick.median / reference) : std::nullopt;
    figures_.push_back({name + ".tick", run.tick.median, "us", against, ratio, run.tick.low, run.tick.high});
    figures_.push_back({name + ".placing", run.placing.median, "us", name + ".tick",
                        run.placing.median / run.tick.median, run.placing.low, run.placing.high});
    figures_.push_back({name + ".broad", run.broad.median, "us", name + ".tick", run.broad.median / run.tick.median,
                        run.broad.low, run.broad.high});
    const auto add = [&](const char* what, double value, const char* unit) {
      figures_.push_back({name + '.' + what, value, unit, "", std::nullopt, value, value});
    };
    add("narrow", run.narrow(), "us");
    add("near", run.near, "pairs");
    add("colliding", run.colliding, "pairs");
    add("far", share(c.pairs_far, all), "of all pairs");
    add("unmoved", share(c.pairs_unmoved, near), "of near pairs");
    add("separated", share(c.pairs_separated, near), "of near pairs");
    add("asked", share(c.pairs_queried, near), "of near pairs");
    add("witnessed", share(c.shapes.pairs_witnessed, shapes), "of pairs of shapes asked");
    add("gaps", share(c.gaps_found, c.gap_searches), "of those sought");
    add("allocations", run.allocations, "a tick");
  }
  void report_plain(const std::string& name, const Quartiles& us) {
    std::printf("%-22s %9.0f us [%.0f %.0f]\n", name.c_str(), us.median, us.low, us.high);
    figures_.push_back({name, us.median, "us", "", std::nullopt, us.low, us.high});
  }
  void report_growth(const std::string& name, const std::map<double, double>& us_of) {
    const double e = fitted_exponent({us_of.begin(), us_of.end()});
    std::printf("%s: n^%.3f from %.0f to %.0f\n", name.c_str(), e, us_of.begin()->first, us_of.rbegin()->first);
    figures_.push_back({name + ".exponent", e, "", "linear: 1", e, e, e});
  }

 private:
  static void subtract(CollisionWatchCounters& of, const CollisionWatchCounters& first) {
    of.pairs_far -= first.pairs_far;
    of.pairs_unmoved -= first.pairs_unmoved;
    of.pairs_queried -= first.pairs_queried;
    of.pairs_separated -= first.pairs_separated;
    of.shapes.pairs_witnessed -= first.shapes.pairs_witnessed;
    of.shapes.pairs_tested -= first.shapes.pairs_tested;
    of.gap_searches -= first.gap_searches;
    of.gaps_found -= first.gaps_found;
  }
  void check(const std::string& name, const World& world, CollisionWatch& watch, const CollisionWatch::Tick& answer,
             bool polygons) {
    SceneQuery fresh(world.scene);
    fresh.set_transforms(world.transforms);
    std::size_t different = 0;
    for (std::uint32_t i = 0; i < watch.interests().size(); ++i) {
      const auto& [collider, collidee, type] = watch.interests()[i];
      const Collision expected = fresh.collide(collider, collidee, type).value();
      different += expected.colliding != std::ranges::binary_search(answer.colliding, i);
      if (polygons) different += watch.collision(i).pairs != expected.pairs;
    }
    if (different > 0) wrong(name + ": " + std::to_string(different) + " interests");
  }
  static void measure_phases(World& world, int warm_up, int ticks, Run& out) {
    SceneQuery query(world.scene);
    const auto broad = make_broad_phase();
    const auto box = [&](std::uint32_t i) { return query.box(ObjectId{2 * i}); };
    for (std::uint32_t i = 0; i < world.transforms.size(); ++i) broad->add(i, box(i));
    for (const CollisionInterest& interest : world.scene.interests) {
      for (const ObjectId collidee : interest.collidees.ends) {
        broad->register_interest(interest.colliders.ends.front().number / 2, collidee.number / 2);
      }
    }
    std::vector<double> placing_us, broad_us;
    std::vector<WorldBox> boxes(world.moving.size());
    for (int tick = 0; tick < warm_up + ticks; ++tick) {
      world.go_to(tick);
      const double start = thread_us();
      for (const std::uint32_t i : world.moving) query.move(i, world.transforms[i]);
      for (std::size_t k = 0; k < boxes.size(); ++k) boxes[k] = box(world.moving[k]);
      const double placed = thread_us();
      for (std::size_t k = 0; k < boxes.size(); ++k) broad->move(world.moving[k], boxes[k]);
      (void)broad->tick();
      if (tick < warm_up) continue;
      broad_us.push_back(thread_us() - placed);
      placing_us.push_back(placed - start);
    }
    out.placing = quartiles(std::move(placing_us));
    out.broad = quartiles(std::move(broad_us));
  }
};

std::vector<NamedSoup> generated(std::uint32_t triangles) {
  return {
      {"knot", bumpy_knot(triangles, 1)}, {"sphere", bumpy_sphere(triangles, 2)}, {"branches", branches(triangles, 3)}};
}

constexpr CoherenceOptions kAll{}, kNothing{false, false}, kWitnesses{true, false}, kGaps{false, true};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  const Options options = parse_options(argc, argv);
  Bench bench(options);
  std::vector<NamedSoup> soups;
  if (!options.quick) soups = soups_of_files(options.arguments, 50000);
  if (soups.empty()) soups = generated(options.quick ? 100 : 1000);
  for (const NamedSoup& named : soups) std::printf("%s: %zu triangles\n", named.name.c_str(), named.soup.faces.size());
  const std::size_t objects = options.quick ? 60 : 1000;
  const Setting all{.objects = objects}, tenth{.objects = objects, .moving = 10},
      still{.objects = objects, .moving = 0};

  const Quartiles plain = bench.plain(all, soups);
  bench.report_plain("plain", plain);
  bench.report("all", bench.run("all", all, soups, kAll), "plain", plain.median);
  bench.report("all.forgetful", bench.run("all.forgetful", all, soups, kNothing), "plain", plain.median);
  bench.report("all.witnesses", bench.run("all.witnesses", all, soups, kWitnesses), "plain", plain.median);
  bench.report("all.gaps", bench.run("all.gaps", all, soups, kGaps), "plain", plain.median);
  const Setting slow{.objects = objects, .speed = 0.1};
  bench.report("slow", bench.run("slow", slow, soups, kAll), "plain", plain.median);
  bench.report("slow.forgetful", bench.run("slow.forgetful", slow, soups, kNothing), "plain", plain.median);
  bench.report("slow.witnesses", bench.run("slow.witnesses", slow, soups, kWitnesses), "plain", plain.median);
  bench.report("slow.gaps", bench.run("slow.gaps", slow, soups, kGaps), "plain", plain.median);
  bench.report("tenth", bench.run("tenth", tenth, soups, kAll), "plain", plain.median);
  bench.report("tenth.forgetful", bench.run("tenth.forgetful", tenth, soups, kNothing), "plain", plain.median);
  bench.report("still", bench.run("still", still, soups, kAll), "plain", plain.median);
  const Setting all_pairs{.objects = objects, .type = peerd::CollisionType::kAllPairs};
  bench.report("polygons", bench.run("polygons", all_pairs, soups, kAll, true));

  std::map<double, double> of_objects, of_triangles, of_contacts;
  const std::vector<NamedSoup> generated_soups = generated(options.quick ? 100 : 1000);
  for (const std::size_t n :
       options.quick ? std::vector<std::size_t>{20, 60} : std::vector<std::size_t>{100, 300, 1000, 3000}) {
    const std::string name = "objects." + std::to_string(n);
    const Run run = bench.run(name, {.objects = n}, generated_soups, kAll);
    bench.report(name, run);
    of_objects[static_cast<double>(n)] = run.tick.median;
  }
  for (const std::uint32_t n :
       options.quick ? std::vector<std::uint32_t>{100, 200} : std::vector<std::uint32_t>{250, 1000, 4000, 16000}) {
    const std::string name = "triangles." + std::to_string(n);
    const Run run = bench.run(name, {.objects = objects}, generated(n), kAll);
    bench.report(name, run);
    of_triangles[n] = run.tick.median;
  }
  for (const double n : {2.5, 5.0, 10.0, 20.0}) {
    const std::string name = "contacts." + std::to_string(static_cast<int>(n * static_cast<double>(objects)));
    const Run run = bench.run(name, {.objects = objects, .close_pairs = n}, generated_soups, kAll);
    bench.report(name, run);
    of_contacts[run.near] = run.tick.median;
  }
  bench.report_growth("objects", of_objects);
  bench.report_growth("triangles", of_triangles);
  bench.report_growth("contacts", of_contacts);
  return bench.finish() ? 0 : 1;
}
