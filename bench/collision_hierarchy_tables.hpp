#pragma once
#include <map>
#include <string>
#include <vector>

#include "collision/query/tree_query.hpp"
#include "collision_report.hpp"

namespace peerd::bench {

struct Prices {  // of the thesis's cost function [s]: Cv, Cu, Cp, and what a query costs besides, its Realignment
  double test = 0, update = 0, triangle = 0, frame = 0;
};

// A row holds what one configuration has cost on one object.
struct HierarchyRow {
  std::string object, rule;
  int k = 0;
  std::uint32_t threshold = 0, height = 0;
  std::size_t nodes = 0, memory_bytes = 0, queries = 0;
  double build_s = 0, witness_s = 0, all_pairs_s = 0;  // a query
  collision::QueryCounters witness = {};               // of all queries
  Prices prices = {};
  double predicted_s = 0;  // a query, from those and prices
};
struct WideRow {
  double build_s, witness_s, all_pairs_s;
  std::size_t memory_bytes;
};
// Tables and figures. `wide`: by object.
void report_hierarchies(const std::vector<HierarchyRow>& rows, const std::map<std::string, WideRow>& wide,
                        Report& report);

}  // namespace peerd::bench
