#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "bench/figures.hpp"
#include "bench/peers/contest.hpp"

namespace peerd::bench::peers {

// One mesh, in one size, and what all engines made of it; ours is the first.
struct Cell {
  std::string mesh;
  std::size_t triangles = 0;
  std::size_t touching = 0, pairs = 0;  // in truth: queries, and pairs of triangles in all of them
  std::optional<double>
      first_answer_ms;  // ours, from nothing; none where no two bodies are near, NaN where it is wrong
  std::vector<Score> scores;
};

void print_cell(const Cell& cell);
// How many times longer the best complete peer takes, over all cells.
void print_summary(std::span<const Cell> cells);
[[nodiscard]] std::string to_json(std::span<const Cell> cells);
[[nodiscard]] std::vector<Figure> to_figures(std::span<const Cell> cells);

}  // namespace peerd::bench::peers
