#pragma once
#include <vector>

#include "collision_meshes.hpp"
#include "collision_report.hpp"

namespace peerd::bench {

// The experiments of the thesis's chapter 3 and what has been added to them. Each hands its figures and tables
// to the report and checks its answers.
void measure_wrong_answers(const std::vector<NamedSoup>& soups, Report& report);   // run time against them
void measure_level_volumes(const std::vector<NamedSoup>& soups, Report& report);   // figure 3.8
void measure_tightness(const std::vector<NamedSoup>& soups, Report& report);       // table 3.1, figures 3.1 and 3.2
void measure_realignment(const std::vector<NamedSoup>& soups, Report& report);     // 3.2.3, 3.2.5
void measure_cut_boundaries(const std::vector<NamedSoup>& soups, Report& report);  // figure 3.9
void measure_lazy_nodes(const std::vector<NamedSoup>& soups, Report& report);      // 3.2.5

// Tables 3.2 to 3.6, and WideTree beside them.
struct HierarchyInput {
  const NamedSoup* object;
  std::vector<int> ks;
  std::vector<std::uint32_t> thresholds;
};
void measure_hierarchies(const std::vector<HierarchyInput>& inputs, Report& report);

}  // namespace peerd::bench
