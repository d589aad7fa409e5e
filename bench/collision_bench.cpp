// Question: which bounding volumes, hierarchies and tests of triangles answer collision queries fastest, and which
// answers are wrong? The experiments of chapter 3 of the thesis that this project grew from, with the library.
//
// collision_bench [--quick] [--out DIR] [--commit NAME] [FILE..]: on generated objects and on OBJ or OFF files, those
// named or six of PEERD_CORPUS/meshes. Beside collision.json and .csv it writes a collision-TABLE.csv for each table.
// Exit code 1: an answer is wrong.
#include <numeric>

#include "collision_experiments.hpp"

namespace peerd::bench {
namespace {

int run(const Options& options) {
  Report report(options);
  const std::uint32_t small = options.quick ? 300 : 2'000, middle = options.quick ? 600 : 8'000;
  std::vector<NamedSoup> smalls, middles, larges, files;
  if (!options.quick || !options.arguments.empty()) files = soups_of_files(options.arguments, 100'000);
  const auto add = [](std::vector<NamedSoup>& to, std::uint32_t triangles, const char* size) {
    to.push_back({std::string("knot_") + size, bumpy_knot(triangles, 1)});
    to.push_back({std::string("sphere_") + size, bumpy_sphere(triangles, 2)});
    to.push_back({std::string("branches_") + size, branches(triangles, 3)});
  };
  add(smalls, small, "2k");
  add(middles, middle, "8k");
  if (!options.quick) add(larges, 32'000, "32k");
  std::vector<NamedSoup> varied = middles;  // of all kinds
  varied.insert(varied.end(), files.begin(), files.end());

  measure_wrong_answers(varied, report);

  std::vector<std::uint32_t> to_20(20);
  std::iota(to_20.begin(), to_20.end(), 1u);
  const std::vector<std::uint32_t> some = {1, 2, 4, 8, 16}, few = {1, 4, 16};
  const std::vector<int> all_k = {6, 14, 18, 26};
  std::vector<HierarchyInput> inputs;
  for (const NamedSoup& s : smalls) inputs.push_back({&s, all_k, options.quick ? few : to_20});
  if (!options.quick) {
    for (const NamedSoup& s : middles) inputs.push_back({&s, all_k, some});
    for (const NamedSoup& s : files) inputs.push_back({&s, {18}, inputs.size() < 9 ? to_20 : few});
    for (const NamedSoup& s : larges) inputs.push_back({&s, {18}, few});
  }
  measure_hierarchies(inputs, report);
  measure_tightness(varied, report);
  measure_level_volumes(varied, report);
  measure_realignment(middles, report);
  measure_cut_boundaries(varied, report);
  measure_lazy_nodes(varied, report);
  return report.finish();
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
