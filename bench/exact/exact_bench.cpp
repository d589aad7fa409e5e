// Question: are the answers about triangles exact, and are the pairs of whole meshes all there?
//
// collision_exact_bench [--general N] [--adversarial N] [--seed S] [--quick] [--out DIR] [--commit NAME]:
//
//   pairs   touch() against the oracle (tests/oracle: integers), on N pairs of ordinary generators (10^7) and N of
//           adversarial ones (10^6), every thousandth of them in all 72 orders; and on the pairs of $PEERD_CORPUS/ccd,
//           whose answers are recorded there
//   meshes  all_pairs() and find_pair() of wide trees and of k-DOP trees, whatever k, threshold and rule, against brute
//           force, on meshes of $PEERD_CORPUS/meshes in many poses
//
// --quick: a hundredth of the pairs, and the smallest meshes. Exit code 1: anything is wrong.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/exact/meshes.hpp"
#include "bench/exact/pairs.hpp"
#include "bench/figures.hpp"

namespace peerd::bench::exact {
namespace {

constexpr std::size_t kMostTriangles = 3000;  // brute force is quadratic
constexpr std::size_t kQuickTriangles = 300;

struct Counts {
  std::uint64_t general = 10'000'000, adversarial = 1'000'000, seed = 1;
};

void add_figures(const char* group, const PairResult& sum, std::vector<Figure>& figures) {
  const std::string of = std::string(group) + '.';
  const auto pairs = static_cast<double>(std::max<std::uint64_t>(sum.pairs, 1));
  const double ours_ns = sum.ours_s / pairs * 1e9, oracle_ns = sum.oracle_s / pairs * 1e9;
  const auto add = [&](const char* what, double value, const char* unit, std::string against = {},
                       std::optional<double> ratio = {}) {
    figures.push_back({of + what, value, unit, std::move(against), ratio, value, value});
  };
  add("pairs", static_cast<double>(sum.pairs), "1");
  add("wrong", static_cast<double>(sum.wrong), "1");
  add("orders", static_cast<double>(sum.permuted), "1");
  add("wrong_orders", static_cast<double>(sum.wrong_permuted), "1");
  add("exact_signs", static_cast<double>(sum.exact) / pairs, "1/pair");
  if (sum.ours_s <= 0) return;
  add("oracle", oracle_ns, "ns");
  add("touch", ours_ns, "ns", of + "oracle", ours_ns / oracle_ns);
}

void print(const PairResult& r) {
  const double pairs = static_cast<double>(std::max<std::uint64_t>(r.pairs, 1));
  std::printf("%-44s %9llu %9llu %6llu %8llu %6llu %9.4f %9.5f %8.1f %9.1f\n", r.name.c_str(),
              static_cast<unsigned long long>(r.pairs), static_cast<unsigned long long>(r.touching),
              static_cast<unsigned long long>(r.wrong), static_cast<unsigned long long>(r.permuted),
              static_cast<unsigned long long>(r.wrong_permuted), static_cast<double>(r.exact) / pairs,
              static_cast<double>(r.wide) / pairs, r.ours_s / pairs * 1e9, r.oracle_s / pairs * 1e9);
  std::fflush(stdout);
}

void add(PairResult& sum, const PairResult& r) {
  sum.pairs += r.pairs;
  sum.touching += r.touching;
  sum.wrong += r.wrong;
  sum.permuted += r.permuted;
  sum.wrong_permuted += r.wrong_permuted;
  sum.exact += r.exact;
  sum.wide += r.wide;
  sum.ours_s += r.ours_s;
  sum.oracle_s += r.oracle_s;
}

std::uint64_t report(const char* group, const std::vector<PairResult>& results, std::vector<Figure>& figures) {
  PairResult sum{.name = std::string("all ") + group};
  for (const PairResult& result : results) add(sum, result);
  print(sum);
  add_figures(group, sum, figures);
  return sum.wrong + sum.wrong_permuted;
}

std::uint64_t check_generators(const char* group, std::span<const oracle::Generator> generators, std::uint64_t pairs,
                               std::uint64_t seed, std::vector<Figure>& figures) {
  std::vector<PairResult> results;
  for (std::size_t i = 0; i < generators.size(); ++i) {  // as evenly as that number can be
    const std::uint64_t share = pairs * (i + 1) / generators.size() - pairs * i / generators.size();
    results.push_back(check_generator(generators[i], seed, share));
    print(results.back());
  }
  return report(group, results, figures);
}

std::uint64_t check_meshes(const std::string& folder, bool quick, std::uint64_t seed, std::vector<Figure>& figures) {
  const std::vector<NamedSoup> soups = read_soups(folder, quick ? kQuickTriangles : kMostTriangles);
  std::printf("%-32s %9s %8s %6s %8s %10s %6s %6s %6s\n", "mesh", "triangles", "polygons", "poses", "touching", "pairs",
              "wide", "kdop", "wrong");
  MeshResult sum{.name = "all meshes"};
  std::uint32_t number = 0;
  const auto print_mesh = [](const MeshResult& r) {
    std::printf("%-32s %9zu %8zu %6llu %8llu %10llu %6llu %6llu %6llu\n", r.name.c_str(), r.triangles, r.polygons,
                static_cast<unsigned long long>(r.poses), static_cast<unsigned long long>(r.touching),
                static_cast<unsigned long long>(r.pairs), static_cast<unsigned long long>(r.wide_queries),
                static_cast<unsigned long long>(r.kdop_queries), static_cast<unsigned long long>(r.wrong));
    std::fflush(stdout);
  };
  for (std::size_t i = 0; i < soups.size(); ++i) {
    const MeshResult r = check_mesh(soups[i], soups[(i + 1) % soups.size()], seed + i, number);
    print_mesh(r);
    sum.triangles += r.triangles;
    sum.polygons += r.polygons;
    sum.poses += r.poses;
    sum.touching += r.touching;
    sum.pairs += r.pairs;
    sum.wide_queries += r.wide_queries;
    sum.kdop_queries += r.kdop_queries;
    sum.wrong += r.wrong;
  }
  print_mesh(sum);
  const auto figure = [&](const char* what, std::uint64_t value) {
    const auto number_of = static_cast<double>(value);
    figures.push_back({std::string("meshes.") + what, number_of, "1", "", {}, number_of, number_of});
  };
  figure("meshes", soups.size());
  figure("poses", sum.poses);
  figure("pairs", sum.pairs);
  figure("queries", sum.wide_queries + sum.kdop_queries);
  figure("wrong", sum.wrong);
  return sum.wrong;
}

int run(const Options& options) {
  Counts counts;
  if (!read_numbers(
          options.arguments,
          {{"--general", &counts.general}, {"--adversarial", &counts.adversarial}, {"--seed", &counts.seed}})) {
    std::fprintf(stderr,
                 "usage: collision_exact_bench [--general N] [--adversarial N] [--seed S] [--quick] [--out DIR] "
                 "[--commit NAME]\n");
    return 2;
  }
  if (options.quick) {
    counts.general /= 100;
    counts.adversarial /= 100;
  }
  std::vector<Figure> figures;
  std::printf("%-44s %9s %9s %6s %8s %6s %9s %9s %8s %9s\n", "pairs of", "pairs", "touching", "wrong", "orders",
              "wrong", "exact/pr", "wide/pr", "ours ns", "oracle ns");
  std::uint64_t wrong = check_generators("general", oracle::general(), counts.general, counts.seed, figures);
  wrong += check_generators("adversarial", oracle::adversarial(), counts.adversarial, counts.seed, figures);
  if (const char* const corpus = std::getenv("PEERD_CORPUS")) {
    const std::vector<PairResult> recorded = check_recorded(corpus);
    for (const PairResult& result : recorded) print(result);
    wrong += report("recorded", recorded, figures);
    wrong += check_meshes(std::string(corpus) + "/meshes", options.quick, counts.seed, figures);
  } else {
    std::printf("no files: PEERD_CORPUS does not name the folder of real ones\n");
  }
  std::printf("%llu wrong answers\n", static_cast<unsigned long long>(wrong));
  if (!write_figures(options, figures)) return 3;
  if (wrong > 0) std::fprintf(stderr, "error: wrong answers; see above\n");
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench::exact

int main(int argc, char** argv) { return peerd::bench::exact::run(peerd::bench::parse_options(argc, argv)); }
