#include "bench/peers/contest.hpp"

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>
#include <random>

#include "bench/figures.hpp"

namespace peerd::bench::peers {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kBuilds = 3;

double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

// The less of two clocks: the wall's runs on while others have the processor, and the processor's own is a call into
// the kernel, of a length that short queries would feel.
class Stopwatch {
 public:
  [[nodiscard]] double us() const {
    const std::chrono::duration<double, std::micro> wall = Clock::now() - wall_;
    return std::min(wall.count(), cpu_us() - cpu_us_);
  }

 private:
  double cpu_us_ = cpu_us();  // asked first and last
  Clock::time_point wall_ = Clock::now();
};

double heap_bytes() {
  const auto heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd);
}

double median(std::vector<double> samples) { return quartiles(std::move(samples)).median; }

class Contestant {
 public:
  Contestant(const EngineKind& kind, const TriangleMesh& mesh) : kind_(kind) {
    score_.engine = kind.name;
    score_.pairs = kind.pairs;
    score_.build_ms = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kBuilds; ++i) {
      engine_.reset();
      engine_ = kind.make();
      const double before = heap_bytes();
      const Stopwatch watch;
      engine_->build(mesh);
      score_.build_ms = std::min(score_.build_ms, watch.us() / 1e3);
      score_.memory_mb = (heap_bytes() - before) / 1e6;
    }
    engine_->make_bodies(kBodies);
  }

  // The first round also finds how many frames the budget is for, and whether answers are true.
  void round(const std::vector<Frame>& frames, const std::vector<std::size_t>& order, const Effort& effort) {
    const bool is_first = rounds_first_.empty();
    std::vector<double> first, all;
    const double begin = cpu_us();
    for (std::size_t i = 0; i < std::min(order.size(), frames_); ++i) {
      run_frame(frames[order[i]], effort, is_first, first, all);
      if (is_first && cpu_us() - begin > effort.budget_s / effort.rounds * 1e6) frames_ = i + 1;
    }
    if (first.empty()) return;  // no two bodies ever met
    score_.queries = first.size();
    rounds_first_.push_back(times(first));
    if (!all.empty()) rounds_all_.push_back(times(all));
  }

  [[nodiscard]] Score score() const {
    Score score = score_;
    if (!rounds_first_.empty()) score.first = median_of(rounds_first_);
    if (!rounds_all_.empty()) score.all = median_of(rounds_all_);
    return score;
  }

 private:
  static Times times(const std::vector<double>& us) {
    return {std::accumulate(us.begin(), us.end(), 0.0) / static_cast<double>(us.size()), median(us)};
  }
  static Times median_of(const std::vector<Times>& rounds) {
    std::vector<double> means, medians;
    for (const Times& t : rounds) {
      means.push_back(t.mean);
      medians.push_back(t.median);
    }
    return {median(means), median(medians)};
  }

  // Least times of all queries, `ask` being one sort of question; what it answered goes to `answers`.
  template <class Answer>
  static std::vector<double> time_queries(const Frame& frame, int timings, std::vector<Answer>& answers, auto ask) {
    std::vector<double> least(frame.queries.size(), std::numeric_limits<double>::infinity());
    answers.resize(frame.queries.size());
    for (int timing = 0; timing < timings; ++timing) {
      for (std::size_t i = 0; i < frame.queries.size(); ++i) {
        const Stopwatch watch;
        const Answer answer = ask(frame.queries[i].a, frame.queries[i].b);
        least[i] = std::min(least[i], watch.us());
        answers[i] = answer;
      }
    }
    return least;
  }

  void run_frame(const Frame& frame, const Effort& effort, bool judge, std::vector<double>& first,
                 std::vector<double>& all) {
    if (frame.queries.empty()) return;
    const Stopwatch watch;
    engine_->move(frame.bodies);
    const double share = watch.us() / static_cast<double>(frame.queries.size());
    std::vector<char> touches;
    for (const double us : time_queries(frame, effort.timings, touches,
                                        [&](std::size_t a, std::size_t b) -> char { return engine_->first(a, b); })) {
      first.push_back(us + share);
    }
    std::vector<std::size_t> counts;
    if (kind_.pairs != Pairs::kNone) {
      for (const double us : time_queries(frame, effort.timings, counts,
                                          [&](std::size_t a, std::size_t b) { return engine_->all(a, b); })) {
        all.push_back(us + share);
      }
    }
    if (!judge) return;
    for (std::size_t i = 0; i < frame.queries.size(); ++i) {
      const std::size_t pairs = frame.queries[i].pairs;
      const bool wrong_first = (touches[i] != 0) != (pairs > 0);
      const bool wrong_all = kind_.pairs != Pairs::kNone && counts[i] != pairs;
      score_.wrong_first += wrong_first;
      score_.wrong_all += wrong_all;
      score_.disagreements += wrong_first || wrong_all;
    }
  }

  EngineKind kind_;
  std::unique_ptr<Engine> engine_;
  Score score_;
  std::size_t frames_ = std::numeric_limits<std::size_t>::max();
  std::vector<Times> rounds_first_, rounds_all_;
};

}  // namespace

std::vector<Score> contest(const TriangleMesh& mesh, const std::vector<Frame>& frames,
                           const std::vector<EngineKind>& engines, const Effort& effort) {
  // The order is drawn so that no frame finds in the cache what the one before it needed, and the first ones are a
  // sample of all.
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::shuffle(order, std::mt19937(5));
  std::vector<Contestant> contestants;
  for (const EngineKind& kind : engines) contestants.emplace_back(kind, mesh);
  for (int round = 0; round < effort.rounds; ++round) {
    for (Contestant& contestant : contestants) contestant.round(frames, order, effort);
  }
  std::vector<Score> scores;
  for (const Contestant& contestant : contestants) scores.push_back(contestant.score());
  return scores;
}

double first_answer_ms(const EngineKind& kind, const TriangleMesh& mesh, const Frame& frame) {
  const Query& query = frame.queries.front();
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kBuilds; ++i) {
    const auto engine = kind.make();
    const Stopwatch watch;
    engine->build(mesh);
    engine->make_bodies(kBodies);
    engine->move(frame.bodies);
    const bool touches = engine->first(query.a, query.b);
    best = std::min(best, watch.us() / 1e3);
    if (touches != (query.pairs > 0)) return std::numeric_limits<double>::quiet_NaN();
  }
  return best;
}

}  // namespace peerd::bench::peers
