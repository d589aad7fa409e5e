#include "collision_report.hpp"

#include <time.h>

#include <algorithm>
#include <cstdio>

namespace peerd::bench {

void Report::figure(const std::string& name, double value, const std::string& unit, const std::string& against,
                    std::optional<double> ratio) {
  figures_.push_back({name, value, unit, against, ratio, value, value});
}

void Report::figure(const std::string& name, const Quartiles& of, const std::string& unit, const std::string& against,
                    std::optional<double> ratio) {
  figures_.push_back({name, of.median, unit, against, ratio, of.low, of.high});
}

void Report::show(const Table& table) {
  std::vector<std::size_t> width;
  for (const std::string& column : table.columns) width.push_back(column.size());
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::printf(i == 0 ? "  %-*s" : "  %*s", static_cast<int>(width[i]), cells[i].c_str());
    }
    std::printf("\n");
  };
  std::printf("\n%s\n", table.title.c_str());
  line(table.columns);
  for (const auto& row : table.rows) line(row);
  std::fflush(stdout);
}

void Report::print(const Table& table) {
  show(table);
  keep(table);
}

void Report::keep(const Table& table) {
  std::string csv;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) csv += (i > 0 ? "," : "") + cells[i];
    csv += '\n';
  };
  line(table.columns);
  for (const auto& row : table.rows) line(row);
  unwritten_ |= !write_beside(options_, BENCH_GROUP "-" + table.name + ".csv", csv);
}

void Report::note(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Report::check(bool right, const std::string& what) {
  if (right) return;
  std::printf("WRONG: %s\n", what.c_str());
  wrong_ = true;
}

int Report::finish() {
  if (!write_figures(options_, figures_) || unwritten_) return 3;
  if (wrong_) std::fprintf(stderr, "error: an answer is wrong, see above\n");
  return wrong_ ? 1 : 0;
}

std::string text(double value, int decimals) {
  char out[64];
  std::snprintf(out, sizeof out, "%.*f", decimals, value);
  return out;
}

std::string text(std::uint64_t value) { return std::to_string(value); }

double seconds_of(const std::function<void()>& work) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

std::vector<Quartiles> race(std::size_t rounds, std::span<const std::function<void()>> runners) {
  std::vector<std::vector<double>> samples(runners.size());
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < runners.size(); ++i) samples[i].push_back(seconds_of(runners[i]));
  }
  std::vector<Quartiles> out;
  for (std::vector<double>& of_one : samples) out.push_back(quartiles(std::move(of_one)));
  return out;
}

}  // namespace peerd::bench
