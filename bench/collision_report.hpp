#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "figures.hpp"

namespace peerd::bench {

// Rows of text under a heading: printed, and written as GROUP-NAME.csv.
struct Table {
  std::string name, title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows = {};
};

// The report takes what the experiments hand in.
class Report {
 public:
  explicit Report(const Options& options) : options_(options) {}
  [[nodiscard]] bool quick() const { return options_.quick; }

  void figure(const std::string& name, double value, const std::string& unit, const std::string& against = "",
              std::optional<double> ratio = {});
  void figure(const std::string& name, const Quartiles& of, const std::string& unit, const std::string& against = "",
              std::optional<double> ratio = {});
  void show(const Table& table);
  void keep(const Table& table);   // in its file
  void print(const Table& table);  // both
  void note(const std::string& line);
  void check(bool right, const std::string& what);  // a wrong answer fails the program

  [[nodiscard]] int finish();  // writes the figures; the exit code

 private:
  Options options_;
  std::vector<Figure> figures_;
  bool wrong_ = false, unwritten_ = false;
};

[[nodiscard]] std::string text(double value, int decimals);
[[nodiscard]] std::string text(std::uint64_t value);

// The time is this thread's CPU time: what other programs take on a shared machine is no part of it.
[[nodiscard]] double seconds_of(const std::function<void()>& work);
// Each round runs all of them, so that what else the machine does falls on all alike [s].
[[nodiscard]] std::vector<Quartiles> race(std::size_t rounds, std::span<const std::function<void()>> runners);

// Keeps a result that nobody reads.
template <class T>
void use(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace peerd::bench
