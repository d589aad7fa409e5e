#include "bench/peers/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

namespace peerd::bench::peers {
namespace {

// This section holds the questions that are compared.

struct Question {
  const char* name;
  std::optional<Times> (*times)(const Score&);
  bool (*complete)(const Score&);  // whether the engine answers it
};
constexpr Question kQuestions[] = {
    {"first", [](const Score& s) -> std::optional<Times> { return s.first; },
     [](const Score& s) { return s.wrong_first == 0; }},
    {"all", [](const Score& s) { return s.all; }, [](const Score& s) { return s.pairs == Pairs::kAll; }},
};
using Statistic = double Times::*;
struct NamedStatistic {
  const char* name;
  Statistic of;
};
constexpr NamedStatistic kStatistics[] = {{"mean", &Times::mean}, {"median", &Times::median}};

const Score& ours(const Cell& cell) { return cell.scores.front(); }

// The fastest of the others that answer it.
const Score* best_peer(const Cell& cell, const Question& question, Statistic statistic) {
  const Score* best = nullptr;
  for (const Score& score : std::span(cell.scores).subspan(1)) {
    const auto times = question.times(score);
    if (!times || score.queries == 0 || !question.complete(score)) continue;
    if (best == nullptr || (*times).*statistic < (*question.times(*best)).*statistic) best = &score;
  }
  return best;
}

double ratio(const Score& theirs, const Score& own, const Question& question, Statistic statistic) {
  return (*question.times(theirs)).*statistic / (*question.times(own)).*statistic;
}

std::string title(const Cell& cell) { return cell.mesh + ' ' + std::to_string(cell.triangles); }

struct Summary {
  double geometric_mean = 0, best = 0, worst = 0;
  std::string worst_cell, worst_peer;
};
std::optional<Summary> summarize(std::span<const Cell> cells, const Question& question, Statistic statistic) {
  Summary summary;
  double logarithms = 0;
  int count = 0;
  for (const Cell& cell : cells) {
    const Score* const peer = best_peer(cell, question, statistic);
    if (peer == nullptr) continue;
    const double times = ratio(*peer, ours(cell), question, statistic);
    logarithms += std::log(times);
    summary.best = std::max(summary.best, times);
    if (count++ > 0 && times >= summary.worst) continue;
    summary.worst = times;
    summary.worst_cell = title(cell);
    summary.worst_peer = peer->engine;
  }
  if (count == 0) return std::nullopt;
  summary.geometric_mean = std::exp(logarithms / count);
  return summary;
}

}  // namespace

void print_cell(const Cell& cell) {
  std::printf("\n%s: %zu queries, %zu touch, %zu pairs of triangles; x: of ours\n", title(cell).c_str(),
              ours(cell).queries, cell.touching, cell.pairs);
  std::printf("%-24s %9s %7s %9s %7s | %9s %7s %9s %7s | %8s %6s %7s %6s | %7s %6s %6s\n", "engine", "first us", "x",
              "median", "x", "all us", "x", "median", "x", "build ms", "x", "MB", "x", "queries", "wrong1", "wrongN");
  for (const Score& score : cell.scores) {
    std::printf("%-24s", score.engine.c_str());
    for (const Question& question : kQuestions) {
      const auto times = question.times(score);
      for (const auto& [name, statistic] : kStatistics) {
        if (times) {
          std::printf(" %9.2f %7.2f", (*times).*statistic, ratio(score, ours(cell), question, statistic));
        } else {
          std::printf(" %9s %7s", "-", "-");
        }
      }
      std::printf(" |");
    }
    std::printf(" %8.2f %6.1f %7.2f %6.2f | %7zu %6zu", score.build_ms, score.build_ms / ours(cell).build_ms,
                score.memory_mb, score.memory_mb / ours(cell).memory_mb, score.queries, score.wrong_first);
    std::printf(" %6s\n", score.pairs == Pairs::kNone ? "-" : std::to_string(score.wrong_all).c_str());
  }
  for (const Question& question : kQuestions) {
    for (const auto& [name, statistic] : kStatistics) {
      const Score* const peer = best_peer(cell, question, statistic);
      if (peer == nullptr) continue;
      std::printf("%s, %s: best complete peer %s, %.2f x ours\n", question.name, name, peer->engine.c_str(),
                  ratio(*peer, ours(cell), question, statistic));
    }
  }
  if (cell.first_answer_ms) {
    std::printf("ours, from nothing built to the first answer: %.2f ms;", *cell.first_answer_ms);
    for (const Score& score : cell.scores)
      std::printf(" %s's build is %.1f x that%c", score.engine.c_str(), score.build_ms / *cell.first_answer_ms,
                  &score == &cell.scores.back() ? '\n' : ',');
  }
  std::fflush(stdout);
}

void print_summary(std::span<const Cell> cells) {
  std::printf("\nbest complete peer / ours, %zu cells\n", cells.size());
  for (const Question& question : kQuestions) {
    for (const auto& [name, statistic] : kStatistics) {
      const auto summary = summarize(cells, question, statistic);
      if (!summary) continue;
      std::printf("%-5s %-6s  geometric mean %6.2f  worst %6.2f (%s, %s)\n", question.name, name,
                  summary->geometric_mean, summary->worst, summary->worst_cell.c_str(), summary->worst_peer.c_str());
    }
  }
}

std::string to_json(std::span<const Cell> cells) {
  const auto pair = [](const std::optional<Times>& times) {
    return times ? nlohmann::ordered_json{{"mean", times->mean}, {"median", times->median}} : nlohmann::ordered_json();
  };
  auto list = nlohmann::ordered_json::array();
  for (const Cell& cell : cells) {
    for (const Score& score : cell.scores) {
      list.push_back({{"engine", score.engine},
                      {"mesh", cell.mesh},
                      {"triangles", cell.triangles},
                      {"first_us", pair(score.first)},
                      {"all_us", pair(score.all)},
                      {"build_ms", score.build_ms},
                      {"memory_mb", score.memory_mb},
                      {"queries", score.queries},
                      {"disagreements", score.disagreements}});
    }
  }
  return list.dump(2);
}

std::vector<Figure> to_figures(std::span<const Cell> cells) {
  std::vector<Figure> figures;
  for (const Question& question : kQuestions) {
    for (const auto& [name, statistic] : kStatistics) {
      if (const auto s = summarize(cells, question, statistic)) {
        figures.push_back({std::string("best_peer.") + question.name + '.' + name, s->geometric_mean, "x", "peerd",
                           s->geometric_mean, s->worst, s->best});
      }
    }
  }
  for (const Cell& cell : cells) {
    const std::string of = cell.mesh + '_' + std::to_string(cell.triangles) + '.';
    if (cell.first_answer_ms) figures.push_back({of + "peerd.first_answer", *cell.first_answer_ms, "ms", "", {}});
    for (const Score& score : cell.scores) {
      const auto add = [&](const std::string& what, double value, const char* unit, double own) {
        const bool itself = &score == &ours(cell);
        const auto against = itself ? std::nullopt : std::optional(value / own);
        figures.push_back(
            {of + score.engine + '.' + what, value, unit, itself ? "" : of + "peerd." + what, against, value, value});
      };
      for (const Question& question : kQuestions) {
        const auto times = question.times(score);
        if (!times) continue;
        for (const auto& [name, statistic] : kStatistics) {
          add(std::string(question.name) + '.' + name, (*times).*statistic, "us",
              (*question.times(ours(cell))).*statistic);
        }
      }
      add("build", score.build_ms, "ms", ours(cell).build_ms);
      add("memory", score.memory_mb, "MB", ours(cell).memory_mb);
      figures.push_back({of + score.engine + ".disagreements", static_cast<double>(score.disagreements), "1", "", {}});
    }
  }
  return figures;
}

}  // namespace peerd::bench::peers
