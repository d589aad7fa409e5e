// Question: which k, rule and threshold make the hierarchy that answers fastest, at what price in memory and building;
// and how does the library's WideTree compare?
#include <algorithm>
#include <map>

#include "collision/exact/triangle_pair.hpp"
#include "collision/query/wide_query.hpp"
#include "collision_experiments.hpp"
#include "collision_hierarchy_tables.hpp"
#include "collision_motion.hpp"

namespace peerd::bench {
namespace {

using collision::KdopTree;
using collision::PolygonPair;
using collision::QueryCounters;
using collision::TreeOptions;
using collision::TriangleSoup;
std::string name_of(collision::SplitRule rule) {
  for (const auto& [of, name] : collision::kSplitRuleNames) {
    if (of == rule) return std::string(name);
  }
  return "?";
}

// An object and the queries about it.
struct Questions {
  std::string object;
  const TriangleSoup& soup;
  std::vector<CloseQuery> queries;
  std::vector<std::vector<PolygonPair>> answers;  // of WideQuery; all trees must have them
};

Questions questions_for(const NamedSoup& object, bool quick) {
  Questions out{object.name, object.soup, close_queries(move_copies(object.soup, quick ? 6 : 90, 1)), {}};
  constexpr std::size_t kMost = 200;
  std::vector<CloseQuery> some;
  const std::size_t most = quick ? 12 : kMost;
  for (std::size_t i = 0; i < most && i < out.queries.size(); ++i) {
    some.push_back(out.queries[i * out.queries.size() / std::min(most, out.queries.size())]);
  }
  out.queries = some;
  collision::WideTree tree(object.soup);
  collision::WideQuery query;
  for (const CloseQuery& q : out.queries) out.answers.push_back(query.all_pairs(tree, tree, q.a_from_b));
  return out;
}

void check_by_brute_force(const Questions& of, Report& report) {
  std::size_t checked = 0;
  for (std::size_t i = 0; i < of.queries.size() && checked < 6; ++i) {
    if (of.answers[i].empty() && i % 50 != 0) continue;
    ++checked;
    std::vector<PolygonPair> pairs;
    collision::OrientationCounters counters;
    for (std::uint32_t j = 0; j < of.soup.faces.size(); ++j) {
      collision::Triangle t = of.soup.triangle(j);
      for (Vec3& p : t) p = of.queries[i].a_from_b(p);
      for (std::uint32_t k = 0; k < of.soup.faces.size(); ++k) {
        if (touch(of.soup.triangle(k), t, counters)) {
          pairs.push_back({of.soup.faces[k].polygon, of.soup.faces[j].polygon});
        }
      }
    }
    std::ranges::sort(pairs);
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    report.check(pairs == of.answers[i], of.object + ": ALLPAIRS is not what brute force finds");
  }
}

template <int K>
Prices prices_of(const Questions& of) {
  KdopTree<K> tree(of.soup, {});
  tree.build_all();
  const auto nodes = tree.nodes();
  const collision::Realignment<K> realign(of.queries.at(0).a_from_b, 1.0);
  std::vector<collision::WideKdop<K>> realigned;
  for (const auto& node : nodes) realigned.push_back(realign(node.dop));
  std::vector<collision::Triangle> triangles;
  for (std::uint32_t i = 0; i < of.soup.faces.size(); ++i) triangles.push_back(of.soup.triangle(i));
  const std::size_t count = std::min<std::size_t>(nodes.size(), 1'000);
  const std::vector<std::function<void()>> runners = {
      [&] {
        std::size_t overlaps = 0;
        for (std::size_t i = 0; i < count; ++i) overlaps += overlap(nodes[i].dop, realigned[(i + 1) % count]) ? 1 : 0;
        use(overlaps);
      },
      [&] {
        for (std::size_t i = 0; i < count; ++i) realigned[i] = realign(nodes[i].dop);
        use(realigned[0]);
      },
      [&] {
        collision::OrientationCounters counters;
        std::size_t touching = 0;
        for (std::size_t i = 3; i < triangles.size() && i < 1'003; ++i) {
          touching += touch(triangles[i], triangles[i - 3], counters) ? 1 : 0;
        }
        use(touching);
      },
      [&] {
        for (const CloseQuery& q : of.queries) use(collision::Realignment<K>(q.a_from_b, 1.0));
      }};
  const auto times = race(9, runners);
  const auto per = [](double s, std::size_t n) { return s / static_cast<double>(n); };
  return {per(times[0].median, count), per(times[1].median, count),
          per(times[2].median, std::min<std::size_t>(triangles.size() - 3, 1'000)),
          per(times[3].median, of.queries.size())};
}

template <int K>
HierarchyRow measure(const Questions& of, const TreeOptions& options, const Prices& prices, Report& report) {
  HierarchyRow row{.object = of.object,
                   .rule = name_of(options.rule),
                   .k = K,
                   .threshold = options.split_threshold,
                   .prices = prices};
  KdopTree<K> tree(of.soup, options);
  row.build_s = seconds_of([&] {
    tree = KdopTree<K>(of.soup, options);
    tree.build_all();
  });
  row.queries = of.queries.size();
  row.height = tree.height();
  row.nodes = tree.nodes().size();
  row.memory_bytes = row.nodes * (sizeof(typename KdopTree<K>::Node) + sizeof(std::uint32_t)) +
                     of.soup.faces.size() * sizeof(std::uint32_t);  // of what queries need; the build's own is left out
  bool same = true;
  for (std::size_t i = 0; i < of.queries.size(); ++i) {
    QueryCounters counters;
    same = same && all_pairs(tree, tree, of.queries[i].a_from_b, counters) == of.answers[i];
    PolygonPair pair{};
    const bool found = find_pair(tree, tree, of.queries[i].a_from_b, row.witness, pair);
    same = same && found == !of.answers[i].empty() && (!found || std::ranges::binary_search(of.answers[i], pair));
  }
  report.check(same, of.object + ": answers of " + row.rule + ", k " + std::to_string(K) + ", threshold " +
                         std::to_string(options.split_threshold));
  const std::vector<std::function<void()>> runners = {[&] {
                                                        QueryCounters counters;
                                                        PolygonPair pair{};
                                                        for (const CloseQuery& q : of.queries)
                                                          use(find_pair(tree, tree, q.a_from_b, counters, pair));
                                                      },
                                                      [&] {
                                                        QueryCounters counters;
                                                        for (const CloseQuery& q : of.queries)
                                                          use(all_pairs(tree, tree, q.a_from_b, counters).size());
                                                      }};
  const auto times = race(report.quick() ? 1 : 7, runners);
  const auto count = static_cast<double>(of.queries.size());
  row.witness_s = times[0].median / count;
  row.all_pairs_s = times[1].median / count;
  row.predicted_s = prices.frame + (static_cast<double>(row.witness.bv_tests) * prices.test +
                                    static_cast<double>(row.witness.bv_updates) * prices.update +
                                    static_cast<double>(row.witness.triangle_tests) * prices.triangle) /
                                       count;
  return row;
}

template <int K>
void sweep(const Questions& of, const HierarchyInput& input, std::vector<HierarchyRow>& rows, Report& report) {
  if (std::ranges::count(input.ks, K) == 0) return;
  const Prices prices = prices_of<K>(of);
  const std::string name = "cost." + of.object + ".k" + std::to_string(K);
  report.figure(name + ".Cv", 1e9 * prices.test, "ns");
  report.figure(name + ".Cu", 1e9 * prices.update, "ns");
  report.figure(name + ".Cp", 1e9 * prices.triangle, "ns");
  for (const auto& named : collision::kSplitRuleNames) {
    for (const std::uint32_t threshold : input.thresholds) {
      rows.push_back(measure<K>(of, {named.rule, threshold}, prices, report));
    }
  }
}

WideRow measure_wide(const Questions& of, Report& report) {
  collision::WideTree tree(of.soup);
  const auto build = [&] {
    tree = collision::WideTree(of.soup);
    tree.build_all();
  };
  collision::WideQuery query;
  const std::vector<std::function<void()>> runners = {build,
                                                      [&] {
                                                        PolygonPair pair{};
                                                        for (const CloseQuery& q : of.queries)
                                                          use(query.find_pair(tree, tree, q.a_from_b, pair));
                                                      },
                                                      [&] {
                                                        for (const CloseQuery& q : of.queries)
                                                          use(query.all_pairs(tree, tree, q.a_from_b).size());
                                                      }};
  const auto times = race(report.quick() ? 1 : 7, runners);
  const auto count = static_cast<double>(of.queries.size());
  bool same = true;
  for (std::size_t i = 0; i < of.queries.size(); ++i) {
    PolygonPair pair{};
    const bool found = query.find_pair(tree, tree, of.queries[i].a_from_b, pair);
    same = same && query.all_pairs(tree, tree, of.queries[i].a_from_b) == of.answers[i] &&
           found == !of.answers[i].empty() && (!found || std::ranges::binary_search(of.answers[i], pair));
  }
  report.check(same, of.object + ": answers of the wide tree");
  return {times[0].median, times[1].median / count, times[2].median / count, tree.memory_bytes()};
}
}  // namespace

void measure_hierarchies(const std::vector<HierarchyInput>& inputs, Report& report) {
  std::vector<HierarchyRow> rows;
  std::map<std::string, WideRow> wide;
  for (const HierarchyInput& input : inputs) {
    const Questions of = questions_for(*input.object, report.quick());
    if (of.queries.empty()) continue;
    if (of.soup.faces.size() <= 2'500) check_by_brute_force(of, report);
    sweep<6>(of, input, rows, report);
    sweep<14>(of, input, rows, report);
    sweep<18>(of, input, rows, report);
    sweep<26>(of, input, rows, report);
    wide[of.object] = measure_wide(of, report);
  }
  report_hierarchies(rows, wide, report);
}

}  // namespace peerd::bench
