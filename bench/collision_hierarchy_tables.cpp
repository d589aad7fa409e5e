#include "collision_hierarchy_tables.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace peerd::bench {
namespace {

Table all_rows(const std::vector<HierarchyRow>& rows) {
  Table table{"hierarchies",
              "",
              {"object", "k", "rule", "threshold", "height", "nodes", "build_ms", "memory_kB", "witness_us",
               "all_pairs_us", "bv_tests", "bv_updates", "triangle_tests", "predicted_us"}};
  for (const HierarchyRow& r : rows) {
    table.rows.push_back(
        {r.object, std::to_string(r.k), r.rule, std::to_string(r.threshold), std::to_string(r.height),
         std::to_string(r.nodes), text(1e3 * r.build_s, 3), text(static_cast<double>(r.memory_bytes) / 1024, 1),
         text(1e6 * r.witness_s, 3), text(1e6 * r.all_pairs_s, 3), std::to_string(r.witness.bv_tests),
         std::to_string(r.witness.bv_updates), std::to_string(r.witness.triangle_tests), text(1e6 * r.predicted_s, 3)});
  }
  return table;
}

// One number of each object and rule, k = 18 and the least threshold.
template <class Value>
Table by_rule(const std::vector<HierarchyRow>& rows, const char* name, const char* title, Value value) {
  Table table{name, title, {"object"}};
  for (const auto& named : collision::kSplitRuleNames) table.columns.emplace_back(named.name);
  for (const HierarchyRow& r : rows) {
    if (r.k != 18 || r.threshold != 1) continue;
    if (table.rows.empty() || table.rows.back()[0] != r.object) table.rows.push_back({r.object});
    table.rows.back().push_back(value(r));
  }
  return table;
}

// The thesis's tables 3.4 to 3.6, k = 18.
Table by_threshold(const std::vector<HierarchyRow>& rows, const std::string& object) {
  Table table{"thresholds-" + object,
              object + ", k = 18: height and kB by splatter, WITNESS us",
              {"threshold", "height", "kB"}};
  for (const auto& named : collision::kSplitRuleNames) table.columns.emplace_back(named.name);
  std::map<std::uint32_t, std::map<std::string, const HierarchyRow*>, std::greater<>> by;
  for (const HierarchyRow& r : rows) {
    if (r.object == object && r.k == 18) by[r.threshold][r.rule] = &r;
  }
  for (const auto& [threshold, of_rule] : by) {
    const HierarchyRow& splatter = *of_rule.at("splatter");
    auto& row = table.rows.emplace_back(std::vector{std::to_string(threshold), std::to_string(splatter.height),
                                                    text(static_cast<double>(splatter.memory_bytes) / 1024, 0)});
    for (const auto& named : collision::kSplitRuleNames) {
      row.push_back(text(1e6 * of_rule.at(std::string(named.name))->witness_s, 3));
    }
  }
  return table;
}

// Geometric means over objects of a configuration's time to its object's best: 1 is a configuration that always wins.
struct Mean {
  double log_sum = 0;
  std::size_t count = 0;
  void add(double ratio) {
    log_sum += std::log(ratio);
    ++count;
  }
  [[nodiscard]] double value() const { return std::exp(log_sum / static_cast<double>(count)); }
};

using Configuration = std::tuple<int, std::string, std::uint32_t>;  // k, rule, threshold

std::vector<HierarchyRow> rows_of_all_k(const std::vector<HierarchyRow>& rows) {
  std::map<std::string, std::size_t> ks;
  for (const HierarchyRow& r : rows) ks[r.object] |= 1u << r.k;
  std::vector<HierarchyRow> out;
  std::ranges::copy_if(rows, std::back_inserter(out),
                       [&](const HierarchyRow& r) { return std::popcount(ks[r.object]) == 4; });
  return out;
}
std::vector<HierarchyRow> rows_of_18(const std::vector<HierarchyRow>& rows) {
  std::vector<HierarchyRow> out;
  std::ranges::copy_if(rows, std::back_inserter(out), [&](const HierarchyRow& r) { return r.k == 18; });
  return out;
}

std::map<std::string, double> best_of(const std::vector<HierarchyRow>& rows, double HierarchyRow::*time) {
  std::map<std::string, double> out;
  for (const HierarchyRow& r : rows) {
    double& best = out.try_emplace(r.object, r.*time).first->second;
    best = std::min(best, r.*time);
  }
  return out;
}

// The ranking holds the configurations that all of these objects have been measured with.
Table ranking(const std::string& name, const std::vector<HierarchyRow>& rows, Report& report) {
  auto best_witness = best_of(rows, &HierarchyRow::witness_s), best_all = best_of(rows, &HierarchyRow::all_pairs_s);
  struct Means {
    Mean witness, all, memory;
  };
  std::map<Configuration, Means> means;
  for (const HierarchyRow& r : rows) {
    Means& of = means[{r.k, r.rule, r.threshold}];
    of.witness.add(r.witness_s / best_witness[r.object]);
    of.all.add(r.all_pairs_s / best_all[r.object]);
    of.memory.add(static_cast<double>(r.memory_bytes) / 1024);
  }
  std::erase_if(means, [&](const auto& of) { return of.second.witness.count < best_witness.size(); });
  std::vector<std::pair<Configuration, Means>> ranked(means.begin(), means.end());
  std::ranges::sort(ranked, {}, [](const auto& r) { return r.second.witness.value() * r.second.all.value(); });
  Table table{name,
              "Configurations, geometric means over " + std::to_string(best_witness.size()) +
                  " objects: time to the object's best, memory",
              {"rank", "k", "rule", "threshold", "WITNESS", "ALLPAIRS", "kB"}};
  for (const auto& [of, mean] : ranked) {
    const auto& [k, rule, threshold] = of;
    table.rows.push_back({std::to_string(table.rows.size() + 1), std::to_string(k), rule, std::to_string(threshold),
                          text(mean.witness.value(), 3), text(mean.all.value(), 3), text(mean.memory.value(), 0)});
    report.figure(name + ".k" + std::to_string(k) + '.' + rule + ".t" + std::to_string(threshold), mean.witness.value(),
                  "", "the object's best WITNESS", mean.witness.value());
  }
  return table;
}

void report_ranking(const std::string& name, const std::vector<HierarchyRow>& rows, Report& report) {
  Table table = ranking(name, rows, report);
  report.keep(table);
  if (table.rows.size() > 12) table.rows.resize(12);
  report.show(table);
}

// The mean over everything else, of k, of the rule and of the threshold alone.
Table by_one_choice(const std::vector<HierarchyRow>& rows) {
  auto best = best_of(rows, &HierarchyRow::witness_s);
  std::map<std::string, Mean> means;
  for (const HierarchyRow& r : rows) {
    const double ratio = r.witness_s / best[r.object];
    means["k " + std::string(r.k < 10 ? " " : "") + std::to_string(r.k)].add(ratio);
    if (r.k != 18) continue;
    means["k 18, " + r.rule].add(ratio);
    means["k 18, threshold " + std::string(r.threshold < 10 ? " " : "") + std::to_string(r.threshold)].add(ratio);
  }
  Table table{"choices", "One choice, the others averaged: WITNESS time to the object's best", {"choice", "mean"}};
  for (const auto& [choice, mean] : means) table.rows.push_back({choice, text(mean.value(), 3)});
  return table;
}

// T = Cf + Nv Cv + Nu Cu + Np Cp, by the counters of WITNESS, against what was measured.
Table cost_function(const std::vector<HierarchyRow>& rows) {
  Table table{
      "cost_function",
      "T = Cf + Nv Cv + Nu Cu + Np Cp of WITNESS (splatter, threshold 4): ns each, counts and us a query; then over "
      "all "
      "rules and thresholds measured/T",
      {"object", "k", "Cf", "Cv", "Cu", "Cp", "Nv", "Nu", "Np", "T", "measured", "quartile", "median", "quartile"}};
  std::map<std::pair<std::string, int>, std::vector<double>> ratios;
  for (const HierarchyRow& r : rows) ratios[{r.object, r.k}].push_back(r.witness_s / r.predicted_s);
  for (const HierarchyRow& r : rows) {
    if (r.rule != "splatter" || r.threshold != 4) continue;
    const auto each = [&](std::uint64_t n) { return text(static_cast<double>(n) / static_cast<double>(r.queries), 1); };
    const Quartiles of = quartiles(ratios[{r.object, r.k}]);
    table.rows.push_back({r.object, std::to_string(r.k), text(1e9 * r.prices.frame, 0), text(1e9 * r.prices.test, 1),
                          text(1e9 * r.prices.update, 1), text(1e9 * r.prices.triangle, 1), each(r.witness.bv_tests),
                          each(r.witness.bv_updates), each(r.witness.triangle_tests), text(1e6 * r.predicted_s, 2),
                          text(1e6 * r.witness_s, 2), text(of.low, 2), text(of.median, 2), text(of.high, 2)});
  }
  return table;
}

void report_winners(const std::vector<HierarchyRow>& rows, const std::map<std::string, WideRow>& wide, Report& report) {
  Table table{"winners",
              "Best configurations and the wide tree: us a query",
              {"object", "best WITNESS", "us", "best ALLPAIRS", "us", "default (18 splatter 4)", "us", "wide WITNESS",
               "wide ALLPAIRS", "best/wide", "wide build ms", "default build ms", "wide kB", "default kB"}};
  for (const auto& [object, of_wide] : wide) {
    const HierarchyRow *witness = nullptr, *all = nullptr, *standard = nullptr;
    for (const HierarchyRow& r : rows) {
      if (r.object != object) continue;
      if (witness == nullptr || r.witness_s < witness->witness_s) witness = &r;
      if (all == nullptr || r.all_pairs_s < all->all_pairs_s) all = &r;
      if (r.k == 18 && r.rule == "splatter" && r.threshold == 4) standard = &r;
    }
    if (standard == nullptr) continue;
    const auto name = [](const HierarchyRow& r) {
      return std::to_string(r.k) + ' ' + r.rule + ' ' + std::to_string(r.threshold);
    };
    table.rows.push_back({object, name(*witness), text(1e6 * witness->witness_s, 2), name(*all),
                          text(1e6 * all->all_pairs_s, 2), text(1e6 * standard->witness_s, 2),
                          text(1e6 * standard->all_pairs_s, 2), text(1e6 * of_wide.witness_s, 2),
                          text(1e6 * of_wide.all_pairs_s, 2), text(witness->witness_s / of_wide.witness_s, 2),
                          text(1e3 * of_wide.build_s, 2), text(1e3 * standard->build_s, 2),
                          text(static_cast<double>(of_wide.memory_bytes) / 1024, 0),
                          text(static_cast<double>(standard->memory_bytes) / 1024, 0)});
    const std::string base = "hierarchy." + object;
    report.figure(base + ".best.witness", 1e6 * witness->witness_s, "us");
    report.figure(base + ".default.witness", 1e6 * standard->witness_s, "us", base + ".best.witness",
                  standard->witness_s / witness->witness_s);
    report.figure(base + ".wide.witness", 1e6 * of_wide.witness_s, "us", base + ".best.witness",
                  of_wide.witness_s / witness->witness_s);
    report.figure(base + ".best.all_pairs", 1e6 * all->all_pairs_s, "us");
    report.figure(base + ".wide.all_pairs", 1e6 * of_wide.all_pairs_s, "us", base + ".best.all_pairs",
                  of_wide.all_pairs_s / all->all_pairs_s);
    report.figure(base + ".cost_function", 1e6 * standard->predicted_s, "us", base + ".default.witness",
                  standard->predicted_s / standard->witness_s);
  }
  table.columns[5] = "default WITNESS", table.columns[6] = "ALLPAIRS";
  report.print(table);
}

}  // namespace

void report_hierarchies(const std::vector<HierarchyRow>& rows, const std::map<std::string, WideRow>& wide,
                        Report& report) {
  report.keep(all_rows(rows));
  report.print(by_rule(rows, "heights", "Levels below the root, k = 18, threshold 1 (the thesis's table 3.2)",
                       [](const HierarchyRow& r) { return std::to_string(r.height); }));
  report.print(by_rule(rows, "build_times", "Time to build [ms], k = 18, threshold 1 (the thesis's table 3.3)",
                       [](const HierarchyRow& r) { return text(1e3 * r.build_s, 1); }));
  for (const auto& [object, of_wide] : wide) {
    const Table table = by_threshold(rows, object);
    if (table.rows.size() >= 20) report.print(table);
  }
  report.print(cost_function(rows));
  report.print(by_one_choice(rows_of_all_k(rows)));
  report_ranking("ranking", rows_of_all_k(rows), report);
  report_ranking("ranking_18", rows_of_18(rows), report);
  report_winners(rows, wide, report);
}

}  // namespace peerd::bench
