#pragma once
#include <optional>
#include <string>
#include <vector>

namespace peerd::bench {

// Every benchmark program takes these options: [--quick] [--out DIR] [--commit NAME] [FILE..].
struct Options {
  bool quick = false;                  // tiny inputs and few rounds: does it still work, not how fast
  std::string out;                     // folder for GROUP.json and GROUP.csv; empty: none is written
  std::string commit;                  // of what is measured, for the record
  std::vector<std::string> arguments;  // all others
};
[[nodiscard]] Options parse_options(int argc, char** argv);

// A whole main(): what `run` answers, or 1 and on stderr what it threw.
[[nodiscard]] int run_main(int argc, char** argv, int (*run)(const Options&));

// One number of a report, beside what it is measured against in the same run.
struct Figure {
  std::string name;  // INPUT.WHAT
  double value = 0;  // the median, where there are several
  std::string unit;
  std::string against;               // a figure of this run, or a target; may be empty
  std::optional<double> ratio;       // to `against`
  double low = value, high = value;  // quartiles
};

// Writes GROUP.json, {"machine": {..}, "figures": {NAME: {"value", "unit", "against", "ratio"}}}, and GROUP.csv with
// the quartiles besides. False where a file cannot be written; says which.
[[nodiscard]] bool write_figures(const Options& options, const std::vector<Figure>& figures);

// Writes a file beside them, where they are written at all. False where it cannot be; says which.
[[nodiscard]] bool write_beside(const Options& options, const std::string& name, const std::string& text);

struct Quartiles {
  double low = 0, median = 0, high = 0;
};
[[nodiscard]] Quartiles quartiles(std::vector<double> samples);  // at least one

}  // namespace peerd::bench
