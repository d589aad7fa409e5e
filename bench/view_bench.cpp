// Question: what does a ray, and what does a look, cost over the hierarchies that exact collision has, beside a plain
// scalar hierarchy whose triangle test rounds; and how often is that one wrong?
//
// view_bench [--quick] [--out DIR] [--commit NAME] [FILE..]: a knot and a sphere of 65,536 triangles (or the OBJ and
// OFF files that are named). Rays:
//   camera  from around the object to anywhere in its box
//   inside  from anywhere in its box in any direction
//   border  from around it through its vertices and the middles of its edges: what may slip through
// Looks: all triangles that may be in a frustum; all Shapes of a scene of 10,000; the nearest polygon of that scene.
// Beside them: `scalar`, a binary tree of binary64 boxes, split at the middle of the longest axis, four triangles a
// leaf, Moeller and Trumbore's test; and `flat`, every box or triangle in turn. Exit code 1: the exact answer differs
// from the exact test of every triangle, a look leaves out what a corner of is in view, or a query allocates.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "collision/scene/scene_query.hpp"
#include "collision_meshes.hpp"
#include "core/geometry/tessellate.hpp"
#include "core/scene/reader.hpp"
#include "figures.hpp"
#include "heap_meter.hpp"

namespace peerd::bench {
namespace {

using collision::Frustum;
using collision::Ray;
using collision::RayHit;
using collision::TriangleSoup;
using collision::WideTree;

// The time is this thread's CPU time [ns], because other threads run beside it.
double now_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e9 + static_cast<double>(now.tv_nsec);
}

struct Random {
  std::mt19937_64 engine{42};
  double between(double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; }
  Vec3 point(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = point(1.0);
      if (p.norm() > 0.1 && p.norm() < 1.0) return p.normalized();
    }
  }
};

// Moeller and Trumbore, in binary64, closed as far as rounding lets it be.
std::optional<double> rounded_hit(const Ray& ray, const collision::Triangle& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], p = ray.direction.cross(v);
  const double determinant = u.dot(p);
  if (determinant == 0.0) return std::nullopt;
  const Vec3 from = ray.origin - t[0];
  const double a = from.dot(p) / determinant;
  if (!(a >= 0.0 && a <= 1.0)) return std::nullopt;
  const Vec3 q = from.cross(u);
  const double b = ray.direction.dot(q) / determinant, at = v.dot(q) / determinant;
  if (!(b >= 0.0 && a + b <= 1.0 && at >= 0.0 && at <= ray.longest)) return std::nullopt;
  return at;
}

class ScalarTree {
 public:
  explicit ScalarTree(const TriangleSoup& soup) : soup_(soup) {
    for (std::uint32_t f = 0; f < soup.faces.size(); ++f) faces_.push_back(f);
    build(0, static_cast<std::uint32_t>(faces_.size()));
  }
  std::optional<RayHit> nearest(Ray ray) {
    std::optional<RayHit> best;
    const Vec3 inverse = ray.direction.cwiseInverse();
    stack_.clear();
    if (const double t = entry(nodes_[0], ray, inverse); t <= ray.longest) stack_.emplace_back(0, t);
    while (!stack_.empty()) {
      const auto [at, t] = stack_.back();
      stack_.pop_back();
      if (t > ray.longest) continue;
      const Node& node = nodes_[at];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const std::uint32_t f = faces_[i];
          const auto hit = rounded_hit(ray, soup_.triangle(f));
          if (!hit || (best && (*hit > best->t || (*hit == best->t && f > best->face)))) continue;
          best = RayHit{soup_.faces[f].polygon, f, *hit};
          ray.longest = *hit;
        }
        continue;
      }
      std::uint32_t near = at + 1, far = node.first;
      double t_near = entry(nodes_[near], ray, inverse), t_far = entry(nodes_[far], ray, inverse);
      if (t_far < t_near) std::swap(near, far), std::swap(t_near, t_far);
      if (t_far <= ray.longest) stack_.emplace_back(far, t_far);
      if (t_near <= ray.longest) stack_.emplace_back(near, t_near);
    }
    return best;
  }

 private:
  struct Node {
    WorldBox box;
    std::uint32_t first = 0, count = 0;  // of faces_; or the second child, the first being the next one
  };
  static double entry(const Node& node, const Ray& ray, const Vec3& inverse) {
    double first = 0.0, last = ray.longest;
    for (int k = 0; k < 3; ++k) {
      const double a = (node.box.lo[k] - ray.origin[k]) * inverse[k], b = (node.box.hi[k] - ray.origin[k]) * inverse[k];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
    return first <= last ? first : std::numeric_limits<double>::quiet_NaN();  // below nothing
  }
  Vec3 middle(std::uint32_t face) const {
    const auto t = soup_.triangle(face);
    return (t[0] + t[1] + t[2]) / 3;
  }
  void build(std::uint32_t begin, std::uint32_t end) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    WorldBox box, middles;
    for (std::uint32_t i = begin; i < end; ++i) {
      for (const Vec3& p : soup_.triangle(faces_[i])) box.merge(p);
      middles.merge(middle(faces_[i]));
    }
    nodes_[at].box = box;
    int axis = 0;
    (middles.hi - middles.lo).maxCoeff(&axis);
    if (end - begin <= 4) {
      nodes_[at].first = begin;
      nodes_[at].count = end - begin;
      return;
    }
    const std::uint32_t half = begin + (end - begin) / 2;
    std::nth_element(faces_.begin() + begin, faces_.begin() + half, faces_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a)[axis] < middle(b)[axis]; });
    build(begin, half);
    nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
    build(half, end);
  }
  const TriangleSoup& soup_;
  std::vector<std::uint32_t> faces_;
  std::vector<Node> nodes_;
  std::vector<std::pair<std::uint32_t, double>> stack_;
};

template <class Test>
std::optional<RayHit> flat_nearest(const TriangleSoup& soup, const Ray& ray, Test test) {
  std::optional<RayHit> best;
  for (std::uint32_t f = 0; f < soup.faces.size(); ++f) {
    const auto t = test(ray, soup.triangle(f));
    if (!t || *t > ray.longest) continue;
    const std::uint32_t polygon = soup.faces[f].polygon;
    if (!best || *t < best->t || (*t == best->t && polygon < best->polygon)) best = RayHit{polygon, f, *t};
  }
  return best;
}

enum class Kind : std::uint8_t { kCamera, kInside, kBorder };
std::vector<Ray> rays_of(Kind kind, const TriangleSoup& soup, std::size_t count) {
  Random random;
  const Vec3 middle = (soup.box.lo + soup.box.hi) / 2, half = (soup.box.hi - soup.box.lo) / 2;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 eye = middle + 3.0 * half.norm() * random.direction();
    const Vec3 any = middle + random.point(1.0).cwiseProduct(half);
    if (kind == Kind::kCamera) rays.push_back({eye, any - eye});
    if (kind == Kind::kInside) rays.push_back({any, random.direction()});
    if (kind != Kind::kBorder) continue;
    const auto t = soup.triangle(static_cast<std::uint32_t>(random.between(0, static_cast<double>(soup.faces.size()))));
    rays.push_back({eye, (i % 2 == 0 ? t[0] : Vec3(t[0] / 2 + t[1] / 2)) - eye});
  }
  return rays;
}

class Bench : public Report {
 public:
  explicit Bench(const Options& options) : Report(options), rounds_(options.quick ? 3 : 25) {}

  void measure(const NamedSoup& named) {
    const TriangleSoup& soup = named.soup;
    const std::string mesh = named.name + '.' + std::to_string(soup.faces.size());
    WideTree tree(soup);
    tree.build_all();
    ScalarTree scalar(soup);
    first_ray(mesh, soup, tree.nodes_built());
    for (const auto& [name, kind] :
         {std::pair{"camera", Kind::kCamera}, std::pair{"inside", Kind::kInside}, std::pair{"border", Kind::kBorder}}) {
      rays(mesh + '.' + name, soup, tree, scalar, rays_of(kind, soup, options_.quick ? 200 : 4000));
    }
    look(mesh + ".faces_in_view", soup, tree);
  }

  // A scene of groups of ten Shapes, each a sphere or a box.
  void measure_scene(std::size_t shapes) {
    std::string text = "#VRML V2.0 utf8\n";
    Random random;
    const double side = std::cbrt(static_cast<double>(shapes)) * 4.0;
    const auto at = [&](const Vec3& p) {
      return "translation " + std::to_string(p[0]) + ' ' + std::to_string(p[1]) + ' ' + std::to_string(p[2]) + ' ';
    };
    for (std::size_t i = 0; i < shapes; ++i) {
      if (i % 10 == 0) text += "Transform { " + at(random.point(side)) + "children [\n";
      text += "Transform { " + at(random.point(5.0)) + "children Shape { geometry ";
      text += i == 0 ? "DEF S Sphere {}" : i == 1 ? "DEF B Box {}" : i % 2 == 0 ? "USE S" : "USE B";
      text += " } }\n";
      if (i % 10 == 9 || i + 1 == shapes) text += "] }\n";
    }
    const auto world = read_world(text);
    if (!world.scene) return wrong("the scene can't be read");
    const std::string name = "scene." + std::to_string(shapes);
    collision::SceneQuery query(*world.scene);
    std::vector<Frustum> frusta;
    std::vector<Ray> rays;
    for (int i = 0; i < 50; ++i) {
      const Quat q(random.between(0.1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      const collision::Camera camera{{random.point(side), q.normalized()}, 0.785398, 16.0 / 9.0, 0.1, side};
      frusta.push_back(collision::make_frustum(camera).value());
      rays.push_back({camera.T_world_camera.position, random.direction()});
    }
    // Boxes of Shapes, each by all planes: what a look costs without a hierarchy.
    std::vector<WorldBox> boxes;
    for (std::uint32_t i = 0; i < world.scene->instances.size(); ++i) {
      if (const Geometry* geometry = world.scene->geometry(ObjectId{i}); geometry != nullptr) {
        WorldBox box;
        const Pose pose = world.scene->rigid_pose(ObjectId{i});
        for (const auto& v : build_mesh(*geometry, world.scene->tessellation).vertices)
          box.merge(pose * v.cast<double>());
        boxes.push_back(box);
      }
    }
    std::size_t seen = 0, flat_seen = 0, hits = 0;
    const auto [look, flat, pick] = timed<3>(
        frusta.size(), {[&] {
                          seen = 0;
                          for (const Frustum& frustum : frusta) seen += query.in_view(frustum).value().size();
                        },
                        [&] {
                          flat_seen = 0;
                          for (const Frustum& frustum : frusta) {
                            for (const WorldBox& box : boxes) {
                              collision::PlaneMask active = frustum.all();
                              flat_seen += collision::in_view(frustum, box, active) != collision::InView::kOutside;
                            }
                          }
                        },
                        [&] {
                          hits = 0;
                          for (const Ray& ray : rays) hits += query.pick(ray.origin, ray.direction).value().has_value();
                        }});
    if (seen != flat_seen) wrong(name + ": other Shapes are in view than one by one");
    if (hits == 0 || hits == rays.size()) wrong(name + ": no ray misses, or none hits");
    report(name + ".flat_in_view", flat, "");
    report(name + ".in_view", look, name + ".flat_in_view", flat.median);
    report(name + ".pick", pick, "");
    const auto counters = query.counters();
    std::printf("%s: %.1f Shapes in view of a frustum, %zu of %zu rays hit, %llu soups and %llu nodes built\n",
                name.c_str(), static_cast<double>(seen) / static_cast<double>(frusta.size()), hits, rays.size(),
                static_cast<unsigned long long>(counters.soups_built),
                static_cast<unsigned long long>(counters.nodes_built));
  }

 private:
  // Quartiles of the time of one of `count` queries [ns], of several ways to ask them, by turns.
  template <std::size_t N>
  std::array<Quartiles, N> timed(std::size_t count, const std::array<std::function<void()>, N>& ways) {
    std::array<std::vector<double>, N> samples;
    for (std::size_t w = 0; w < N; ++w) {
      ways[w]();
      samples[w].reserve(static_cast<std::size_t>(rounds_));
    }
    std::size_t allocated = 0;
    for (int round = 0; round < rounds_; ++round) {
      for (std::size_t w = 0; w < N; ++w) {
        const HeapMeter meter;
        const double start = now_ns();
        ways[w]();
        samples[w].push_back((now_ns() - start) / static_cast<double>(count));
        allocated += meter.allocations();
      }
    }
    if (allocated > 0) wrong(std::to_string(allocated) + " allocations in queries like those before");
    std::array<Quartiles, N> out;
    for (std::size_t w = 0; w < N; ++w) out[w] = quartiles(std::move(samples[w]));
    return out;
  }
  void report(const std::string& name, const Quartiles& ns, const std::string& against, double other = 0.0) {
    std::optional<double> ratio;
    if (!against.empty()) ratio = ns.median / other;
    figures_.push_back({name, ns.median, "ns", against, ratio, ns.low, ns.high});
    std::printf("%-44s %12.1f ns  [%.1f %.1f]", name.c_str(), ns.median, ns.low, ns.high);
    if (ratio) std::printf("  %.3f of %s", *ratio, against.c_str());
    std::printf("\n");
    std::fflush(stdout);
  }
  void count(const std::string& name, double value, const std::string& unit) {
    figures_.push_back({name, value, unit, "", std::nullopt, value, value});
    std::printf("%-44s %12.3f %s\n", name.c_str(), value, unit.c_str());
  }

  // The first ray is asked of a mesh that nobody has asked for yet.
  void first_ray(const std::string& mesh, const TriangleSoup& soup, std::size_t all) {
    const auto rays = rays_of(Kind::kCamera, soup, 20);
    std::vector<double> samples, built, everything;
    for (const Ray& ray : rays) {
      collision::RayQuery query;
      double start = now_ns();
      WideTree tree(soup);
      (void)query.nearest(tree, ray);
      samples.push_back(now_ns() - start);
      built.push_back(static_cast<double>(tree.nodes_built()));
      start = now_ns();
      WideTree whole(soup);
      whole.build_all();
      everything.push_back(now_ns() - start);
    }
    const double whole = quartiles(everything).median;
    report(mesh + ".build_all", quartiles(everything), "");
    report(mesh + ".first_ray", quartiles(samples), mesh + ".build_all", whole);
    count(mesh + ".first_ray.nodes", quartiles(built).median / static_cast<double>(all), "of all nodes built");
  }

  void rays(const std::string& name, const TriangleSoup& soup, WideTree& tree, ScalarTree& scalar,
            const std::vector<Ray>& rays) {
    collision::RayQuery query;
    std::vector<std::optional<RayHit>> found(rays.size()), rounded(rays.size());
    const auto before = query.counters();
    const auto [wide, plain] = timed<2>(rays.size(), {[&] {
                                                        for (std::size_t i = 0; i < rays.size(); ++i)
                                                          found[i] = query.nearest(tree, rays[i]);
                                                      },
                                                      [&] {
                                                        for (std::size_t i = 0; i < rays.size(); ++i)
                                                          rounded[i] = scalar.nearest(rays[i]);
                                                      }});
    const double asked = static_cast<double>(rays.size()) * (rounds_ + 1);
    report(name + ".scalar", plain, "");
    report(name + ".exact", wide, name + ".scalar", plain.median);
    const auto& after = query.counters();
    const auto per_ray = [&](std::uint64_t last, std::uint64_t first) {
      return static_cast<double>(last - first) / asked;
    };
    count(name + ".boxes", per_ray(after.bv_tests, before.bv_tests), "boxes a ray");
    count(name + ".triangles", per_ray(after.triangle_tests, before.triangle_tests), "exact tests a ray");
    count(name + ".open", per_ray(after.orientation.exact, before.orientation.exact),
          "signs a ray that the filter left");
    std::size_t hits = 0, slipped = 0, other = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      hits += found[i].has_value();
      slipped += found[i].has_value() != rounded[i].has_value();
      other += found[i] && rounded[i] && found[i]->polygon != rounded[i]->polygon &&
               std::abs(found[i]->t - rounded[i]->t) > 1e-9 * found[i]->t;
    }
    count(name + ".hits", static_cast<double>(hits) / static_cast<double>(rays.size()), "of rays");
    count(name + ".scalar.wrong", static_cast<double>(slipped + other), "rays of " + std::to_string(rays.size()));
    collision::OrientationCounters counters;
    const std::size_t checks = options_.quick ? 20 : 100;
    const auto exact = [&](const Ray& ray, const collision::Triangle& t) {
      return collision::first_parameter(ray, t, counters);
    };
    std::vector<double> flat;
    std::size_t flat_wrong = 0;
    for (std::size_t i = 0; i < checks; ++i) {
      const auto expected = flat_nearest(soup, rays[i], exact);
      if (expected.has_value() != found[i].has_value() ||
          (expected && (expected->t != found[i]->t || expected->polygon != found[i]->polygon))) {
        wrong(name + ": ray " + std::to_string(i) + " hits something else first");
      }
      const double start = now_ns();
      const auto by_rounding = flat_nearest(soup, rays[i], rounded_hit);
      flat.push_back(now_ns() - start);
      flat_wrong += by_rounding.has_value() != expected.has_value();
    }
    const Quartiles each = quartiles(flat);
    report(name + ".flat", each, name + ".exact", wide.median);
    count(name + ".flat.wrong", static_cast<double>(flat_wrong), "rays of " + std::to_string(checks));
  }

  void look(const std::string& name, const TriangleSoup& soup, WideTree& tree) {
    Random random;
    const Vec3 middle = (soup.box.lo + soup.box.hi) / 2;
    const double size = (soup.box.hi - soup.box.lo).norm();
    std::vector<Frustum> frusta;
    while (frusta.size() < 40) {
      const Quat q(random.between(0.1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      const collision::Camera camera{
          {middle + random.point(0.5 * size), q.normalized()}, 0.785398, 16.0 / 9.0, 1e-3, size};
      frusta.push_back(collision::make_frustum(camera).value());
    }
    collision::ViewQuery query;
    std::size_t seen = 0, flat_seen = 0;
    const auto beyond = [](const Frustum& frustum, const collision::Triangle& t) {
      for (std::size_t n = 0; n < frustum.count(); ++n) {
        const Vec3& normal = frustum[n].normal;
        if (std::max({normal.dot(t[0]), normal.dot(t[1]), normal.dot(t[2])}) + frustum[n].offset_m < 0.0) return true;
      }
      return false;
    };
    const auto [wide, flat] = timed<2>(frusta.size(), {[&] {
                                                         seen = 0;
                                                         for (const Frustum& frustum : frusta)
                                                           seen += query.faces_in_view(tree, Pose{}, frustum).size();
                                                       },
                                                       [&] {
                                                         flat_seen = 0;
                                                         for (const Frustum& frustum : frusta) {
                                                           for (std::uint32_t f = 0; f < soup.faces.size(); ++f)
                                                             flat_seen += !beyond(frustum, soup.triangle(f));
                                                         }
                                                       }});
    report(name + ".flat", flat, "");
    report(name, wide, name + ".flat", flat.median);
    for (const Frustum& frustum : frusta) {
      std::vector<bool> listed(soup.faces.size());
      for (const std::uint32_t f : query.faces_in_view(tree, Pose{}, frustum)) listed[f] = true;
      for (std::uint32_t f = 0; f < soup.faces.size(); ++f) {
        if (!listed[f] && !beyond(frustum, soup.triangle(f))) return wrong(name + " leaves out a triangle");
      }
    }
    count(name + ".share", static_cast<double>(seen) / static_cast<double>(frusta.size() * soup.faces.size()),
          "of all triangles");
    count(name + ".needless",
          static_cast<double>(seen - flat_seen) / static_cast<double>(std::max<std::size_t>(seen, 1)),
          "of those, by rounding");
  }

  int rounds_;
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  const Options options = parse_options(argc, argv);
  Bench bench(options);
  std::vector<NamedSoup> soups;
  const std::uint32_t triangles = options.quick ? 2000 : 65536;
  if (options.arguments.empty()) {
    soups.push_back({"knot", bumpy_knot(triangles, 1)});
    soups.push_back({"sphere", bumpy_sphere(triangles, 1)});
  } else {
    soups = soups_of_files(options.arguments, 1'000'000);
  }
  for (const NamedSoup& soup : soups) bench.measure(soup);
  bench.measure_scene(options.quick ? 200 : 10'000);
  return bench.finish() ? 0 : 1;
}
