// The main() of groups that are written with Google Benchmark. A benchmark's real time becomes a figure; where it sets
// the counter `ratio`, that is the figure's ratio, and its label says against what. Other counters become figures
// NAME.COUNTER. A benchmark that skips with an error has found a wrong answer.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <vector>

#include "figures.hpp"

namespace peerd::bench {
namespace {

class Collector : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const std::string name = run.benchmark_name();
      wrong = wrong || run.error_occurred;
      if (run.error_occurred || run.run_type == Run::RT_Aggregate) continue;
      Figure figure{.name = name,
                    .value = run.GetAdjustedRealTime(),
                    .unit = benchmark::GetTimeUnitString(run.time_unit),
                    .against = run.report_label,
                    .ratio = {}};
      figure.low = figure.high = figure.value;
      for (const auto& [counter, value] : run.counters) {
        if (counter == "ratio") figure.ratio = value.value;
      }
      figures.push_back(figure);
      for (const auto& [counter, value] : run.counters) {
        if (counter == "ratio") continue;
        figures.push_back({.name = name + '.' + counter, .value = value.value, .unit = {}, .against = {}, .ratio = {}});
      }
    }
  }
  std::vector<Figure> figures;
  bool wrong = false;
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  Options options = parse_options(argc, argv);
  if (options.quick) options.arguments.insert(options.arguments.begin(), "--benchmark_min_time=0.001");
  std::vector<char*> arguments = {argv[0]};
  for (std::string& argument : options.arguments) arguments.push_back(argument.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  if (!write_figures(options, collector.figures)) return 3;
  if (collector.wrong) std::fprintf(stderr, "error: a benchmark's answer is wrong, see above\n");
  return collector.wrong ? 1 : 0;
}
