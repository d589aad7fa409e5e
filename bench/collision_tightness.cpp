// Question: how much larger than its convex hull is an object's box, ball, oriented box or k-DOP, as it turns? And how
// do the volumes of a hierarchy's levels shrink by the rule that splits?
#include <array>
#include <numbers>

#include "collision/volumes/convex_hull.hpp"
#include "collision/volumes/enclosing_ball.hpp"
#include "collision/volumes/enclosing_box.hpp"
#include "collision/volumes/level_volumes.hpp"
#include "collision/volumes/turned_volume.hpp"
#include "collision_experiments.hpp"
#include "collision_hull.hpp"
#include "generated_text.hpp"

namespace peerd::bench {
namespace {

constexpr double kPi = std::numbers::pi;

// Volumes as the thesis has them in its figures 3.1 and 3.2, % of the hull's.
constexpr std::size_t kVolumes = 4;
constexpr std::array<const char*, kVolumes> kNames = {"AABB", "14-DOP", "18-DOP", "26-DOP"};

std::array<double, kVolumes> volumes_of(const collision::ConvexHull& hull, const Mat3& turn) {
  const double percent = 100 / hull.volume_m3;
  return {percent * volume(collision::kdop_around<6>(hull.corners, turn)),
          percent * volume(collision::kdop_around<14>(hull.corners, turn)),
          percent * volume(collision::kdop_around<18>(hull.corners, turn)),
          percent * volume(collision::kdop_around<26>(hull.corners, turn))};
}

Quat random_rotation(Random& random) {  // uniform: Shoemake, Graphics Gems III, 1992
  const double u = random.real(0, 1), v = random.real(0, 2 * kPi), w = random.real(0, 2 * kPi);
  return {std::sqrt(1 - u) * std::sin(v), std::sqrt(1 - u) * std::cos(v), std::sqrt(u) * std::sin(w),
          std::sqrt(u) * std::cos(w)};
}

}  // namespace

void measure_tightness(const std::vector<NamedSoup>& soups, Report& report) {
  const std::uint32_t steps = report.quick() ? 10 : 1'000;
  Table table{"tightness",
              "Mean volume over " + std::to_string(7 * steps) +
                  " rotations, % of the convex hull's (the thesis's table 3.1): random ones, and the thesis's (s)",
              {"object", "hull corners"}};
  for (const char* name : kNames) table.columns.insert(table.columns.end(), {name, std::string(name) + " s"});
  table.columns.insert(table.columns.end(), {"OBB", "sphere"});
  for (const NamedSoup& object : soups) {
    const auto hull = collision::convex_hull(object.soup.vertices);
    if (!hull) {
      report.note(object.name + " is flat");
      continue;
    }
    Random random(23);
    std::array<double, kVolumes> thesis_sums{}, randoms{};
    bool ordered = true;
    for (std::uint32_t i = 0; i < 7 * steps; ++i) {
      const auto thesis_volumes = volumes_of(*hull, collision::thesis_rotation(i, steps));
      const auto any = volumes_of(*hull, random_rotation(random).toRotationMatrix());
      const auto no_larger = [&](std::size_t v, std::size_t than) {
        return thesis_volumes[v] <= thesis_volumes[than] + 1e-6;
      };  // rounding
      ordered = ordered && no_larger(2, 0) && no_larger(3, 2) && no_larger(3, 1) && thesis_volumes[3] > 100 - 1e-6;
      for (std::size_t v = 0; v < kVolumes; ++v) {
        thesis_sums[v] += thesis_volumes[v] / (7 * steps);
        randoms[v] += any[v] / (7 * steps);
      }
    }
    report.check(ordered, object.name + ": a k-DOP of more slabs is larger, or the hull is");
    const auto by_qhull = qhull_volume(object.soup.vertices);
    report.check(by_qhull && std::abs(*by_qhull / hull->volume_m3 - 1) < 1e-9,
                 object.name + ": the hull is not Qhull's");
    const double box = 100 * volume(collision::small_box(*hull)) / hull->volume_m3;
    const double ball = 100 * volume(collision::smallest_ball(hull->corners)) / hull->volume_m3;
    auto& row = table.rows.emplace_back(std::vector{object.name, text(std::uint64_t{hull->corners.size()})});
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
}

void measure_level_volumes(const std::vector<NamedSoup>& soups, Report& report) {
  Table table{
      "level_volumes",
      "Volume of all nodes of a level, with the leaves above it, % of the root's; k = 18, threshold 1 (the thesis's "
      "figure 3.8)",
      {"object", "level"}};
  for (const auto& named : collision::kSplitRuleNames) table.columns.emplace_back(named.name);
  Table few = table;
  for (const NamedSoup& object : soups) {
    std::vector<std::vector<double>> by_rule;
    for (const auto& named : collision::kSplitRuleNames) {
      collision::KdopTree<18> tree(object.soup, {named.rule, 1});
      tree.build_all();
      std::vector<double>& levels = by_rule.emplace_back(collision::level_volumes(tree));
      const double root = levels.front();
      for (double& v : levels) v *= 100 / root;
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
}

}  // namespace peerd::bench
