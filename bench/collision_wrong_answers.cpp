// Question: what does it cost to be right about two triangles, and how often are the cheaper tests wrong?
#include <algorithm>
#include <array>

#include "collision_descent.hpp"
#include "collision_experiments.hpp"
#include "collision_motion.hpp"
#include "collision_narrow.hpp"
#include "collision_pairs.hpp"
#include "core/box.hpp"
#include "generated_text.hpp"
#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::bench {
namespace {

using collision::KdopTree;
using collision::Triangle;
constexpr std::size_t kTimed = 20'000;  // pairs, 3 MB of them

oracle::Triangle as_oracle(const Triangle& t) {
  oracle::Triangle out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = {t[i][0], t[i][1], t[i][2]};
  return out;
}

struct Result {
  std::array<double, 5> ns{}, wrong_per_million{};
  double filter_share = 0;  // of the pairs: answered without an exact sign
  double exact_signs = 0;   // a pair
  double touching = 0;
};

Result measure(PairInput& input, Report& report) {
  const auto& tests = narrow_tests();
  Random random(3);
  for (std::size_t i = input.pairs.size(); i > 1; --i) {
    std::swap(input.pairs[i - 1], input.pairs[random.below(static_cast<std::uint32_t>(i))]);
  }
  const auto count = static_cast<double>(input.pairs.size());
  std::array<std::size_t, 5> wrong{};
  std::size_t without_exact = 0, exact_signs = 0, touching = 0, oracle_differs = 0;
  const std::size_t sampled = report.quick() ? 300 : 20'000;
  for (std::size_t i = 0; i < input.pairs.size(); ++i) {
    const auto& [a, b] = input.pairs[i];
    collision::OrientationCounters counters;
    const bool truth = collision::touch(a, b, counters);
    touching += truth ? 1 : 0;
    without_exact += counters.exact == 0 ? 1 : 0;
    exact_signs += counters.exact;
    if (i < sampled) oracle_differs += oracle::touch(as_oracle(a), as_oracle(b)) != truth ? 1 : 0;
    for (std::size_t t = 0; t < tests.size(); ++t) wrong[t] += tests[t].touch(a, b) != truth ? 1 : 0;
  }
  report.check(oracle_differs == 0, input.name + ": exact answers that are not the oracle's");

  Result result;
  result.filter_share = static_cast<double>(without_exact) / count;
  result.exact_signs = static_cast<double>(exact_signs) / count;
  result.touching = static_cast<double>(touching) / count;
  const std::span timed(input.pairs.data(), std::min(kTimed, input.pairs.size()));
  std::vector<std::function<void()>> runners;
  for (const Narrow& test : tests) {
    runners.emplace_back([timed, test] {
      std::size_t touched = 0;
      for (const auto& [a, b] : timed) touched += test.touch(a, b) ? 1 : 0;
      use(touched);
    });
  }
  const auto times = race(report.quick() ? 3 : 15, runners);
  for (std::size_t t = 0; t < tests.size(); ++t) {
    const double per_pair = 1e9 / static_cast<double>(timed.size());
    result.ns[t] = times[t].median * per_pair;
    result.wrong_per_million[t] = 1e6 * static_cast<double>(wrong[t]) / count;
    const std::string name = "narrow." + input.name + '.' + tests[t].name;
    report.figure(name + ".time", {times[t].low * per_pair, times[t].median * per_pair, times[t].high * per_pair}, "ns",
                  "narrow." + input.name + ".double.time", times[t].median / times[kDouble].median);
    report.figure(name + ".wrong", result.wrong_per_million[t], "per million");
  }
  report.figure("narrow." + input.name + ".filter_alone", 100 * result.filter_share, "%", "99.99 %");
  return result;
}

void compare_pairs(std::vector<PairInput>& inputs, Report& report) {
  const auto& tests = narrow_tests();
  Table table{"narrow", "Triangle pairs: ns a pair (median), wrong answers per million", {"input", "pairs", "touch %"}};
  for (const Narrow& test : tests) table.columns.insert(table.columns.end(), {std::string(test.name) + " ns", "wrong"});
  table.columns.insert(table.columns.end(), {"exact/double", "filter alone %", "exact signs"});
  struct Worst {
    double ratio = 0, filter_share = 1;
  } general, resting_ones;
  for (PairInput& input : inputs) {
    if (input.pairs.empty()) continue;
    const Result result = measure(input, report);
    auto& row = table.rows.emplace_back(
        std::vector{input.name, text(std::uint64_t{input.pairs.size()}), text(100 * result.touching, 1)});
    const bool resting = input.name.starts_with("resting"), moving = input.name.starts_with("moving");
    for (std::size_t t = 0; t < tests.size(); ++t) {
      row.insert(row.end(), {text(result.ns[t], 1), text(result.wrong_per_million[t], 1)});
    }
    const double ratio = result.ns[kExact] / result.ns[kDouble];
    row.insert(row.end(), {text(ratio, 2), text(100 * result.filter_share, 4), text(result.exact_signs, 2)});
    if (resting || moving) {
      Worst& worst = resting ? resting_ones : general;
      worst.ratio = std::max(worst.ratio, ratio);
      worst.filter_share = std::min(worst.filter_share, result.filter_share);
      report.figure("narrow." + input.name + ".exact_to_double", ratio, "", resting ? "12" : "1.3",
                    ratio / (resting ? 12 : 1.3));
    }
  }
  report.print(table);
  report.note("exact/double at most: general " + text(general.ratio, 2) + " (demanded: 1.3), resting " +
              text(resting_ones.ratio, 2) + " (12); general pairs that the filter answers alone, at least " +
              text(100 * general.filter_share, 4) + " % (99.99)");
}

Table wrong_by_generator(const std::vector<PairInput>& inputs) {
  Table table{"adversarial", "", {"generator", "pairs"}};
  for (const Narrow& test : narrow_tests()) table.columns.emplace_back(test.name);
  for (const PairInput& input : inputs) {
    auto& row = table.rows.emplace_back(std::vector{input.name, text(std::uint64_t{input.pairs.size()})});
    for (const Narrow& test : narrow_tests()) {
      const auto wrong = std::ranges::count_if(input.pairs, [&](const TrianglePair& pair) {
        return test.touch(pair.a, pair.b) != narrow_tests()[kExact].touch(pair.a, pair.b);
      });
      row.push_back(std::to_string(wrong));
    }
  }
  return table;
}

// Two objects: BOX, and WITNESS by each of the tests.
void compare_objects(const NamedSoup& object, Table& table, Report& report) {
  const auto frames = move_copies(object.soup, report.quick() ? 5 : 60, 1);
  const auto queries = close_queries(frames);
  KdopTree<18> tree(object.soup, {});
  tree.build_all();
  std::vector<std::vector<char>> answers(1 + narrow_tests().size(), std::vector<char>(queries.size()));
  const auto box = [&](const Pose& at) {
    const Mat3 rotation = at.orientation.toRotationMatrix();
    WorldBox out;
    for (const Vec3& v : object.soup.vertices) out.merge(Vec3(rotation * v + at.position));
    return out;
  };
  std::vector<std::function<void()>> runners = {[&] {  // the boxes of a frame once, as the thesis's update does
    std::array<WorldBox, kCopies> boxes;
    std::uint32_t known = ~0u;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const CloseQuery& q = queries[i];
      if (q.frame != known) std::ranges::transform(frames[q.frame], boxes.begin(), box);
      known = q.frame;
      answers[0][i] = (boxes[q.a].lo.array() <= boxes[q.b].hi.array()).all() &&
                      (boxes[q.b].lo.array() <= boxes[q.a].hi.array()).all();
    }
  }};
  for (std::size_t t = 0; t < narrow_tests().size(); ++t) {
    runners.emplace_back([&, t] {
      for (std::size_t i = 0; i < queries.size(); ++i) {
        answers[t + 1][i] = descend_pairs(tree, tree, queries[i].a_from_b, narrow_tests()[t].touch);
      }
    });
  }
  const auto times = race(report.quick() ? 2 : 7, runners);
  const std::vector<char>& truth = answers.back();
  std::vector<std::string> row = {object.name, text(std::uint64_t{queries.size()}),
                                  text(100.0 * static_cast<double>(std::ranges::count(truth, 1)) /
                                           static_cast<double>(std::max<std::size_t>(1, queries.size())),
                                       1)};
  for (std::size_t r = 0; r < runners.size() && !queries.empty(); ++r) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) wrong += answers[r][i] != truth[i] ? 1 : 0;
    const double count = static_cast<double>(queries.size()), us = 1e6 * times[r].median / count;
    const double share = 1e6 * static_cast<double>(wrong) / count;
    row.insert(row.end(), {text(us, 2), text(share, 0)});
    const std::string name = "query." + object.name + '.' + (r == 0 ? "BOX" : narrow_tests()[r - 1].name);
    report.figure(name + ".time", us, "us");
    report.figure(name + ".wrong", share, "per million");
  }
  row.resize(table.columns.size());
  table.rows.push_back(row);
}

}  // namespace

void measure_wrong_answers(const std::vector<NamedSoup>& soups, Report& report) {
  std::vector<PairInput> inputs;
  Table table{"query",
              "Two objects in close proximity: us a query, wrong answers per million queries",
              {"object", "queries", "touch %", "BOX us", "wrong"}};
  for (const Narrow& test : narrow_tests()) {
    table.columns.insert(table.columns.end(), {std::string("WITNESS ") + test.name + " us", "wrong"});
  }
  for (const NamedSoup& object : soups) {
    inputs.push_back(moving_pairs(object, report.quick()));
    compare_objects(object, table, report);
  }
  report.print(table);
  for (PairInput& input : resting_pairs(report.quick())) inputs.push_back(std::move(input));
  const std::vector<PairInput> adversarial = adversarial_pairs(report.quick());
  report.keep(wrong_by_generator(adversarial));
  inputs.push_back({"adversarial", {}});
  for (const PairInput& input : adversarial) {
    inputs.back().pairs.insert(inputs.back().pairs.end(), input.pairs.begin(), input.pairs.end());
  }
  compare_pairs(inputs, report);
}

}  // namespace peerd::bench
