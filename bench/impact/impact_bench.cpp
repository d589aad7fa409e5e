// Question: is the time of impact of two meshes never later than the truth, and how early is it?
//
// impact_bench [--pairs N] [--first I] [--seed S] [--quick] [--out DIR] [--commit NAME]: N (10^5) pairs of random
// meshes that move and turn (moving_pairs.hpp), number I and on. Each answer is compared with the exact test at 200
// instants of the step, at instants that come ever nearer to the time of impact, and at those of a walk that goes as
// far as the distance of the meshes allows, or a two-hundredth of the smaller one (checks.hpp). --quick: a hundredth.
//
//   false_negatives  meshes that touch before the time, or touch where there was to be no contact
//   not_near         hits farther apart than the tolerance
//   wrong_starts     the answer at the start isn't that of the exact test
//   parting          hits whose nearest points part, while corners two tolerances farther off approach
//   early            of hits that touch: (when they do - the time) * the speed at which their nearest points approach,
//                    in tolerances
//
// Exit code 1: any of the first three, or work that ran out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "bench/figures.hpp"
#include "bench/impact/checks.hpp"

namespace peerd::bench::impact {
namespace {

using collision::MeshImpactState;

constexpr std::uint64_t kMostSamples = 5000;  // of a walk; more where little is between
constexpr std::uint64_t kMostPrinted = 20;
constexpr double kEarly = 2.0;  // tolerances: then its speed of approach falls, and it is shown

struct Wish {
  std::uint64_t pairs = 100'000, first = 0, seed = 1;
};

bool is_wrong(const Judgement& j) {
  return j.false_negative || j.not_near || j.wrong_start || j.impact.state == MeshImpactState::kIterationLimit ||
         j.impact.state == MeshImpactState::kTooLarge;
}

struct Sums {
  std::array<std::uint64_t, 5> states{};
  std::uint64_t samples = 0, iterations = 0, max_iterations = 0;
  std::uint64_t false_negatives = 0, not_near = 0, wrong_starts = 0, parting = 0, resting = 0, touched = 0, wrong = 0;
  std::vector<double> early, distance;  // in tolerances

  [[nodiscard]] std::uint64_t of(MeshImpactState state) const { return states[static_cast<std::size_t>(state)]; }

  void add(const Judgement& j) {
    ++states[static_cast<std::size_t>(j.impact.state)];
    samples += j.samples;
    iterations += j.impact.iterations;
    max_iterations = std::max<std::uint64_t>(max_iterations, j.impact.iterations);
    false_negatives += j.false_negative;
    not_near += j.not_near;
    wrong_starts += j.wrong_start;
    parting += j.parts;
    wrong += is_wrong(j);
    touched += j.touched;
    if (j.impact.state != MeshImpactState::kHit || j.false_negative) return;
    resting += j.impact.resting;
    distance.push_back(j.distance_m / j.reached_m);
    if (j.touched) early.push_back(j.early_m / j.reached_m);
  }
};

void print_case(std::uint64_t number, const MovingPair& pair, const Judgement& j) {
  const char* what = "out of work";
  if (j.early_m > kEarly * j.reached_m) what = "early";
  if (j.parts) what = "parts";
  if (j.wrong_start) what = "WRONG START";
  if (j.not_near) what = "NOT NEAR";
  if (j.false_negative) what = "FALSE NEGATIVE";
  std::printf(
      "%s: pair %llu, %s and %s, state %d at %.17g of %g s, touches at %.17g; %g m apart, tolerance %g m, %u "
      "iterations\n",
      what, static_cast<unsigned long long>(number), pair.kind_a, pair.kind_b, static_cast<int>(j.impact.state),
      j.impact.time_s, pair.step_s, j.touches_s, j.distance_m, pair.tolerance_m, j.impact.iterations);
}

double at(const std::vector<double>& sorted, double part) {
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

std::vector<Figure> figures_of(Sums& sums) {
  std::ranges::sort(sums.early);
  std::ranges::sort(sums.distance);
  std::vector<Figure> figures;
  const auto add = [&](const char* what, double value, const char* unit) {
    figures.push_back({std::string("pairs.") + what, value, unit, "", std::nullopt, value, value});
    std::printf("%-28s %14.6g %s\n", what, value, unit);
  };
  const auto count = [&](const char* what, std::uint64_t n) { add(what, static_cast<double>(n), "1"); };
  std::uint64_t pairs = 0;
  for (const std::uint64_t n : sums.states) pairs += n;
  count("pairs", pairs);
  count("hits", sums.of(MeshImpactState::kHit));
  count("separated", sums.of(MeshImpactState::kSeparated));
  count("overlapped", sums.of(MeshImpactState::kOverlapped));
  count("out_of_work", sums.of(MeshImpactState::kIterationLimit));
  count("samples", sums.samples);
  count("false_negatives", sums.false_negatives);
  count("not_near", sums.not_near);
  count("wrong_starts", sums.wrong_starts);
  count("parting", sums.parting);
  count("resting", sums.resting);
  count("touch_later", sums.touched);
  add("iterations", static_cast<double>(sums.iterations) / static_cast<double>(std::max<std::uint64_t>(pairs, 1)),
      "1/pair");
  count("iterations.most", sums.max_iterations);
  constexpr std::pair<const char*, double> kParts[] = {
      {"least", 0.0}, {"median", 0.5}, {"p99", 0.99}, {"p999", 0.999}, {"most", 1.0}};
  for (const auto& [name, part] : kParts)
    add((std::string("early.") + name).c_str(), at(sums.early, part), "tolerances");
  for (const auto& [name, part] : kParts)
    add((std::string("distance.") + name).c_str(), at(sums.distance, part), "tolerances");
  return figures;
}

int run(const Options& options) {
  Wish wish;
  if (!read_numbers(options.arguments, {{"--pairs", &wish.pairs}, {"--first", &wish.first}, {"--seed", &wish.seed}})) {
    std::fprintf(stderr,
                 "usage: impact_bench [--pairs N] [--first I] [--seed S] [--quick] [--out DIR] [--commit NAME]\n");
    return 2;
  }
  if (options.quick) wish.pairs /= 100;
  Sums sums;
  Checker checker(kMostSamples);
  std::uint64_t printed = 0;
  for (std::uint64_t i = wish.first; i < wish.first + wish.pairs; ++i) {
    collision::Numbers numbers(wish.seed * 1'000'003 + i);  // so that any pair can be asked for alone
    const MovingPair pair = random_pair(numbers);
    const Judgement judgement = checker.judge(pair);
    sums.add(judgement);
    const bool odd = judgement.parts || judgement.early_m > kEarly * judgement.reached_m;
    if ((is_wrong(judgement) || odd) && ++printed <= kMostPrinted) {
      print_case(i, pair, judgement);
    }
  }
  const std::vector<Figure> figures = figures_of(sums);
  if (!write_figures(options, figures)) return 3;
  if (sums.wrong > 0) std::fprintf(stderr, "error: wrong answers; see above\n");
  return sums.wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench::impact

int main(int argc, char** argv) { return peerd::bench::impact::run(peerd::bench::parse_options(argc, argv)); }
