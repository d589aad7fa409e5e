// Question: how much larger than its convex hull is an object's box, ball, oriented box or k-DOP, as it turns? And how
// do the volumes of a hierarchy's levels shrink by the rule that splits?
#include <array>
#include <numbers>

#include "collision/tree/kdop_tree.hpp"
#include "collision_experiments.hpp"
#include "collision_hull.hpp"
#include "collision_kdops.hpp"
#include "generated_text.hpp"

namespace peerd::bench {
namespace {

constexpr double kPi = std::numbers::pi;

void check_hulls(Report& report) {
  std::vector<Vec3> cube, sphere;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  cube.emplace_back(0.5, 0.25, 0.5);
  const auto of_cube = convex_hull(cube);
  report.check(of_cube && of_cube->vertices.size() == 8 && std::abs(of_cube->volume_m3 - 1) < 1e-12,
               "the convex hull of a cube");
  report.check(std::abs(oriented_box_volume(cube) - 1) < 1e-3, "the oriented box of a cube");
  report.check(std::abs(ball_volume(cube) - kPi * std::sqrt(3.0) / 2) < 1e-2, "the ball around a cube");
  constexpr int kPoints = 20'000;  // a spiral over the sphere: about even
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1 - (2.0 * i + 1) / kPoints, r = std::sqrt(1 - z * z), angle = i * kPi * (3 - std::sqrt(5.0));
    sphere.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  const auto of_sphere = convex_hull(sphere);
  // Inside the sphere; of n even points the hull lacks some 4.8 / n of the volume.
  report.check(of_sphere && of_sphere->volume_m3 < 4.0 / 3 * kPi && of_sphere->volume_m3 > 4.0 / 3 * kPi * (1 - 1e-3),
               "the convex hull of a sphere");
  report.check(!convex_hull(std::vector<Vec3>(5, Vec3::Ones())), "the convex hull of one point");
}

// Volumes as the thesis has them in its figures 3.1 and 3.2, % of the hull's.
constexpr std::size_t kVolumes = 4;
constexpr std::array<const char*, kVolumes> kNames = {"AABB", "14-DOP", "18-DOP", "26-DOP"};

std::array<double, kVolumes> volumes_of(const Hull& hull, const Quat& turn, std::vector<Vec3>& turned) {
  const Mat3 rotation = turn.toRotationMatrix();
  turned.clear();
  for (const Vec3& p : hull.vertices) turned.push_back(rotation * p);
  const double percent = 100 / hull.volume_m3;
  return {percent * volume(bound<6>(turned)), percent * volume(bound<14>(turned)), percent * volume(bound<18>(turned)),
          percent * volume(bound<26>(turned))};
}

// Around x, y, z, xy, xz, yz and xyz, a full turn each.
Quat thesis_rotation(int i, int steps) {
  constexpr int kAxes[7][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  const auto& axis = kAxes[i / steps];
  return quat_exp(2 * kPi * (i % steps) / steps * Vec3(axis[0], axis[1], axis[2]).normalized());
}

Quat random_rotation(Random& random) {  // uniform: Shoemake, Graphics Gems III, 1992
  const double u = random.real(0, 1), v = random.real(0, 2 * kPi), w = random.real(0, 2 * kPi);
  return {std::sqrt(1 - u) * std::sin(v), std::sqrt(1 - u) * std::cos(v), std::sqrt(u) * std::sin(w),
          std::sqrt(u) * std::cos(w)};
}

}  // namespace

void measure_tightness(const std::vector<NamedSoup>& soups, Report& report) {
  check_hulls(report);
  const int steps = report.quick() ? 10 : 1'000;
  Table table{"tightness",
              "Mean volume over " + std::to_string(7 * steps) +
                  " rotations, % of the convex hull's (the thesis's table 3.1): random ones, and the thesis's (s)",
              {"object", "hull corners"}};
  for (const char* name : kNames) table.columns.insert(table.columns.end(), {name, std::string(name) + " s"});
  table.columns.insert(table.columns.end(), {"OBB", "sphere"});
  std::vector<Chart> charts;
  for (const NamedSoup& object : soups) {
    const auto hull = convex_hull(object.soup.vertices);
    if (!hull) {
      report.note(object.name + " is flat");
      continue;
    }
    Random random(23);
    std::array<double, kVolumes> thesis_sums{}, randoms{};
    std::vector<Vec3> scratch;
    Chart& chart = charts.emplace_back(Chart{object.name,
                                             {.label = "rotations: x, y, z, xy, xz, yz, xyz", .from_zero = true},
                                             {.label = "% of the hull's volume"},
                                             {}});
    for (const char* name : kNames) chart.series.push_back({.name = name, .points = {}});
    bool ordered = true;
    for (int i = 0; i < 7 * steps; ++i) {
      const auto thesis_volumes = volumes_of(*hull, thesis_rotation(i, steps), scratch);
      const auto any = volumes_of(*hull, random_rotation(random), scratch);
      const auto no_larger = [&](std::size_t v, std::size_t than) {
        return thesis_volumes[v] <= thesis_volumes[than] + 1e-6;
      };  // rounding
      ordered = ordered && no_larger(2, 0) && no_larger(3, 2) && no_larger(3, 1) && thesis_volumes[3] > 100 - 1e-6;
      for (std::size_t v = 0; v < kVolumes; ++v) {
        thesis_sums[v] += thesis_volumes[v] / (7 * steps);
        randoms[v] += any[v] / (7 * steps);
        if (i % std::max(1, steps / 100) == 0)
          chart.series[v].points.push_back({static_cast<double>(i), thesis_volumes[v]});
      }
    }
    report.check(ordered, object.name + ": a k-DOP of more slabs is larger, or the hull is");
    const double box = 100 * oriented_box_volume(hull->vertices) / hull->volume_m3;
    const double ball = 100 * ball_volume(hull->vertices) / hull->volume_m3;
    const double end = 7 * steps;
    chart.series.push_back({.name = "OBB", .points = {{0, box}, {end, box}}});
    chart.series.push_back({.name = "sphere", .points = {{0, ball}, {end, ball}}});
    auto& row = table.rows.emplace_back(std::vector{object.name, text(std::uint64_t{hull->vertices.size()})});
    for (std::size_t v = 0; v < kVolumes; ++v) {
      row.insert(row.end(), {text(randoms[v], 1), text(thesis_sums[v], 1)});
      report.figure("tightness." + object.name + '.' + kNames[v], randoms[v], "%", "convex hull", randoms[v] / 100);
    }
    row.insert(row.end(), {text(box, 1), text(ball, 1)});
    report.figure("tightness." + object.name + ".OBB", box, "%", "convex hull", box / 100);
    report.figure("tightness." + object.name + ".sphere", ball, "%", "convex hull", ball / 100);
  }
  std::vector<std::string> mean = {"mean", ""};
  for (std::size_t column = 2; column < table.columns.size(); ++column) {
    double sum = 0;
    for (const auto& row : table.rows) sum += std::stod(row[column]);
    mean.push_back(text(sum / static_cast<double>(std::max<std::size_t>(1, table.rows.size())), 1));
  }
  table.rows.push_back(mean);
  report.print(table);
  report.picture("tightness", charts, 3);
}

void measure_level_volumes(const std::vector<NamedSoup>& soups, Report& report) {
  Table table{
      "level_volumes",
      "Volume of all nodes of a level, with the leaves above it, % of the root's; k = 18, threshold 1 (the thesis's "
      "figure 3.8)",
      {"object", "level"}};
  for (const auto& named : collision::kSplitRuleNames) table.columns.emplace_back(named.name);
  std::vector<Chart> charts;
  Table few = table;
  for (const NamedSoup& object : soups) {
    Chart& chart = charts.emplace_back(
        Chart{object.name, {.label = "level"}, {.label = "% of the root's volume", .logarithmic = true}, {}});
    std::vector<std::vector<double>> by_rule;
    for (const auto& named : collision::kSplitRuleNames) {
      collision::KdopTree<18> tree(object.soup, {named.rule, 1});
      tree.build_all();
      std::vector<double>& levels = by_rule.emplace_back();
      std::vector<std::uint32_t> level = {0}, next;
      double of_leaves = 0;
      while (!level.empty()) {
        double sum = of_leaves;
        next.clear();
        for (const std::uint32_t i : level) {
          const double of_node = volume(widened(tree.node(i).dop));
          sum += of_node;
          const std::uint32_t left = tree.node(i).left;
          if (left < collision::KdopTree<18>::kUnsplit) {
            next.insert(next.end(), {left, left + 1});
          } else {
            of_leaves += of_node;
          }
        }
        levels.push_back(sum);
        level.swap(next);
      }
      const double root = levels.front();
      Series series{.name = std::string(named.name), .points = {}};
      for (double& v : levels) {
        v *= 100 / root;
        series.points.push_back({static_cast<double>(&v - levels.data()), v});
      }
      chart.series.push_back(series);
      for (const std::size_t l : {4u, 8u, 12u}) {
        if (l < levels.size()) {
          report.figure("volume." + object.name + ".level" + std::to_string(l) + '.' + std::string(named.name),
                        levels[l], "%");
        }
      }
    }
    std::size_t most = 0;
    for (const auto& levels : by_rule) most = std::max(most, levels.size());
    for (std::size_t l = 0; l < most; ++l) {
      std::vector<std::string> row = {object.name, std::to_string(l)};
      for (const auto& levels : by_rule) row.push_back(text(levels[std::min(l, levels.size() - 1)], 3));
      table.rows.push_back(row);
      if (l == 4 || l == 8 || l == 12) few.rows.push_back(row);
    }
  }
  report.keep(table);
  report.show(few);
  report.picture("level_volumes", charts, 3);
}

}  // namespace peerd::bench
