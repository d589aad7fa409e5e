#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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

// Collects a benchmark's figures, and whether an answer was wrong.
class Report {
 public:
  explicit Report(Options options) : options_(std::move(options)) {}

  // Writes the figures. False where they cannot be written, or where something was wrong.
  [[nodiscard]] bool finish() const { return write_figures(options_, figures_) && right_; }

 protected:
  void add(Figure figure) { figures_.push_back(std::move(figure)); }
  void add_and_print(Figure figure);
  void wrong(const std::string& what);

  Options options_;
  std::vector<Figure> figures_;
  bool right_ = true;
};

// Sets the numbers that the arguments give, each behind the name of its option. False where one is no whole number, or
// behind no such name.
using NumberOption = std::pair<std::string_view, std::uint64_t*>;
[[nodiscard]] bool read_numbers(const std::vector<std::string>& arguments, std::initializer_list<NumberOption> options);

struct Quartiles {
  double low = 0, median = 0, high = 0;
};
[[nodiscard]] Quartiles quartiles(std::vector<double> samples);  // at least one

}  // namespace peerd::bench
