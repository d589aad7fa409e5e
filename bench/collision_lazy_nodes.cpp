// Question: shall an object's nodes be kept in the world's frame and transformed when they are first visited, known by
// a frame counter or by the matrix they were last transformed with (the thesis's 3.2.5)? Or shall each query transform
// one object's visited nodes to the other one's frame, as the library does, and keep nothing?
#include <array>
#include <cstring>

#include "collision/exact/triangle_pair.hpp"
#include "collision_descent.hpp"
#include "collision_experiments.hpp"
#include "collision_motion.hpp"

namespace peerd::bench {
namespace {

using Tree = collision::KdopTree<18>;
using Dop = collision::WideKdop<18>;

enum class Keep { kNothing, kFrameCounter, kMatrix };
constexpr std::array<const char*, 3> kNames = {"nothing", "frame counter", "matrix"};

struct Matrix {
  std::array<double, 12> numbers{};
  explicit Matrix(const collision::RelativeMotion& m) {
    std::memcpy(numbers.data(), m.rotation.data(), 9 * sizeof(double));
    std::memcpy(numbers.data() + 9, m.translation.data(), 3 * sizeof(double));
  }
  Matrix() = default;
  friend bool operator==(const Matrix&, const Matrix&) = default;
};

// The nodes of one copy in the world's frame.
struct WorldNodes {
  struct Counted {
    Dop dop;
    std::uint32_t frame = 0;
  };
  struct WithMatrix {
    Dop dop;
    Matrix at;
  };
  std::vector<Counted> counted;
  std::vector<WithMatrix> with_matrix;
};

struct Work {
  std::uint64_t bv_tests = 0, updates = 0;
  std::vector<std::size_t> answers = {};  // touching pairs by query; of WITNESS at most one
};

Work run(Tree& tree, const std::vector<Frame>& frames, const std::vector<CloseQuery>& queries, Keep keep, bool all) {
  Work work;
  std::vector<WorldNodes> copies(kCopies);
  for (WorldNodes& copy : copies) {
    if (keep == Keep::kFrameCounter) copy.counted.resize(tree.nodes().size());
    if (keep == Keep::kMatrix) copy.with_matrix.resize(tree.nodes().size());
  }
  std::vector<collision::Realignment<18>> to_world;
  std::vector<Matrix> matrices;
  std::uint32_t known = ~0u;
  for (const CloseQuery& q : queries) {
    if (keep != Keep::kNothing && q.frame != known) {
      to_world.clear(), matrices.clear();
      for (const Pose& pose : frames[q.frame]) {
        const collision::RelativeMotion world_from_copy({}, pose);
        to_world.emplace_back(world_from_copy, kExtent_m);
        matrices.emplace_back(world_from_copy);
      }
      known = q.frame;
    }
    std::size_t touching = 0;
    collision::OrientationCounters counters;
    const auto at_leaves = each_pair(tree, tree, q.a_from_b, [&](const auto& a, const auto& b) {
      if (!touch(a, b, counters)) return false;
      ++touching;
      return !all;
    });
    const auto descend = [&](auto bound_a, auto bound_b) {
      Descent descent(tree, tree, bound_a, bound_b, at_leaves);
      (void)descent.run();
      work.bv_tests += descent.bv_tests;
    };
    const auto by_counter = [&](std::uint32_t copy) {
      return [&, copy](std::uint32_t i) -> const Dop& {
        WorldNodes::Counted& node = copies[copy].counted[i];
        if (node.frame != q.frame + 1) {
          ++work.updates;
          node = {to_world[copy](tree.node(i).dop), q.frame + 1};
        }
        return node.dop;
      };
    };
    const auto by_matrix = [&](std::uint32_t copy) {
      return [&, copy](std::uint32_t i) -> const Dop& {
        WorldNodes::WithMatrix& node = copies[copy].with_matrix[i];
        if (node.at != matrices[copy]) {
          ++work.updates;
          node = {to_world[copy](tree.node(i).dop), matrices[copy]};
        }
        return node.dop;
      };
    };
    if (keep == Keep::kFrameCounter) descend(by_counter(q.a), by_counter(q.b));
    if (keep == Keep::kMatrix) descend(by_matrix(q.a), by_matrix(q.b));
    if (keep == Keep::kNothing) {
      const collision::Realignment<18> realign(q.a_from_b, kExtent_m);
      descend([&](std::uint32_t i) -> const collision::Kdop<18>& { return tree.node(i).dop; },
              [&](std::uint32_t i) {
                ++work.updates;
                return realign(tree.node(i).dop);
              });
    }
    work.answers.push_back(touching);
  }
  return work;
}

// Each copy keeps its place for ten frames; one copy a frame moves.
std::vector<Frame> seldom_moving(const std::vector<Frame>& frames) {
  std::vector<Frame> out = frames;
  for (std::uint32_t f = 0; f < out.size(); ++f) {
    for (std::uint32_t i = 0; i < kCopies; ++i) out[f][i] = frames[f < i ? 0 : f - (f - i) % kCopies][i];
  }
  return out;
}

}  // namespace

void measure_lazy_nodes(const std::vector<NamedSoup>& soups, Report& report) {
  Table table{"lazy_nodes",
              "What of transformed nodes is kept between queries: us, node transformations and BV tests a frame",
              {"object", "copies that move", "query"}};
  for (const char* name : kNames) {
    table.columns.insert(table.columns.end(), {std::string(name) + " us", "Nu", "Nv"});
  }
  table.columns.insert(table.columns.end(), {"counter/nothing", "matrix/nothing"});
  for (const NamedSoup& object : soups) {
    Tree tree(object.soup, {});
    tree.build_all();
    const auto all_move = move_copies(object.soup, report.quick() ? 4 : 60, 1);
    for (const bool seldom : {false, true}) {
      const auto frames = seldom ? seldom_moving(all_move) : all_move;
      const auto queries = close_queries(frames);
      for (const bool all : {false, true}) {
        std::array<Work, 3> works;
        std::vector<std::function<void()>> runners;
        for (std::size_t k = 0; k < 3; ++k) {
          runners.emplace_back([&, k] { works[k] = run(tree, frames, queries, static_cast<Keep>(k), all); });
        }
        const auto times = race(report.quick() ? 1 : 5, runners);
        const auto count = static_cast<double>(frames.size());
        auto& row = table.rows.emplace_back(
            std::vector<std::string>{object.name, seldom ? "1" : "10", all ? "ALLPAIRS" : "WITNESS"});
        for (std::size_t k = 0; k < 3; ++k) {
          report.check(works[k].answers == works[0].answers, object.name + ": answers with lazy nodes");
          row.insert(row.end(),
                     {text(1e6 * times[k].median / count, 1), text(static_cast<double>(works[k].updates) / count, 0),
                      text(static_cast<double>(works[k].bv_tests) / count, 0)});
          report.figure("lazy." + object.name + (seldom ? ".seldom." : ".all.") + (all ? "ALLPAIRS." : "WITNESS.") +
                            (k == 0   ? "nothing"
                             : k == 1 ? "frame_counter"
                                      : "matrix"),
                        1e6 * times[k].median / count, "us", "nothing", times[k].median / times[0].median);
        }
        row.insert(row.end(), {text(times[1].median / times[0].median, 2), text(times[2].median / times[0].median, 2)});
      }
    }
  }
  report.print(table);
}

}  // namespace peerd::bench
