// Question: how long does it take to find whether two meshes touch, and where, beside Debian's other collision engines?
//
// bench_peers [--mesh knot|sphere|tree|FILE] [--triangles N] [--seed S] [--frames F] [--engines NAME,..] [--avx2]
//             [--json] [--quick] [--out DIR] [--commit NAME] [FILE..]: ten bodies of one mesh in motion (motion.hpp),
// the same for all engines. Without --mesh and FILEs: each of the generated meshes in three sizes. --engines: these
// beside ours, instead of all. --avx2: ours does without AVX-512. --json prints a list with an object for each engine
// and mesh instead of the tables.
//
//   peerd                   WideTree, built to the end, and WideQuery
//   fcl-OBB, fcl-OBBRSS     FCL as Debian has compiled it, binary64
//   fcl-OBB-float           its templates, compiled here for this machine, binary32
//   fcl-KDOP18-float-refit  ", k-DOPs of every body refitted to the world once a frame, which queries share the time of
//   ode                     OPCODE within ODE; pairs are merged
//   cgal-rigid              exact, and without pairs
//   pqp                     PQP (github.com/GammaUNC/PQP), where it is installed: cmake -DCMAKE_PREFIX_PATH=FOLDER
//   coal-OBB, coal-OBBRSS   Coal, once HPP-FCL (github.com/coal-library/coal), where it is installed, binary64
//
// The peers are compiled for this machine (-O3 -march=native), ours as it is for users. Truth is what CGAL's exact
// predicates say of the vertices in the world; an engine that computes in another frame can differ from it by their
// rounding. Exit code 1: we differ in more than one query of a thousand.
#include <hwy/targets.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "bench/figures.hpp"
#include "bench/peers/contest.hpp"
#include "bench/peers/report.hpp"

namespace peerd::bench::peers {
namespace {

constexpr std::size_t kQueriesADisagreement = 1000;

struct Wish {
  std::vector<std::string> meshes;
  std::optional<int> triangles;
  unsigned seed = 1;
  int frames = 60;
  std::vector<std::string> engines;  // the names of those beside ours; empty: all
  bool avx512 = true;
  bool json = false;
};

template <class Number>
bool read_number(std::string_view text, Number least, Number& number) {
  Number read{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
  if (error != std::errc{} || end != text.data() + text.size() || read < least) return false;
  number = read;
  return true;
}

// The names between commas.
std::vector<std::string> split_names(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream in(list);
  for (std::string name; std::getline(in, name, ',');) names.push_back(name);
  return names;
}

// Every engine that was built in, ours first.
std::vector<EngineKind> all_engines() {
  return {
      peerd_engine(), fcl_obb(),     fcl_obbrss(), fcl_obb_float(), fcl_kdop18_float_refit(), ode(), cgal_rigid(),
#ifdef BENCH_PEERS_HAS_PQP
      pqp(),
#endif
#ifdef BENCH_PEERS_HAS_COAL
      coal_obb(),     coal_obbrss(),
#endif
  };
}
std::vector<EngineKind> engines_of(const Wish& wish) {
  std::vector<EngineKind> engines = all_engines();
  if (wish.engines.empty()) return engines;
  std::erase_if(engines, [&, ours = std::string_view(engines.front().name)](const EngineKind& kind) {
    return kind.name != ours && std::ranges::find(wish.engines, kind.name) == wish.engines.end();
  });
  return engines;
}
bool are_engines(const std::vector<std::string>& names) {
  const std::vector<EngineKind> engines = all_engines();
  return !names.empty() && std::ranges::all_of(names, [&](const std::string& name) {
    return std::ranges::any_of(engines, [&](const EngineKind& kind) { return kind.name == name; });
  });
}

std::optional<Wish> parse(const std::vector<std::string>& arguments) {
  Wish wish;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& option = arguments[i];
    if (option == "--json") {
      wish.json = true;
      continue;
    }
    if (option == "--avx2") {
      wish.avx512 = false;
      continue;
    }
    if (!option.starts_with("--")) {
      wish.meshes.push_back(option);
      continue;
    }
    if (++i == arguments.size()) return std::nullopt;
    const std::string& value = arguments[i];
    bool good = true;
    if (option == "--mesh") {
      wish.meshes.push_back(value);
    } else if (option == "--triangles") {
      good = read_number(value, 100, wish.triangles.emplace());
    } else if (option == "--seed") {
      good = read_number(value, 0u, wish.seed);
    } else if (option == "--frames") {
      good = read_number(value, 1, wish.frames);
    } else if (option == "--engines") {
      wish.engines = split_names(value);
      good = are_engines(wish.engines);
    } else {
      good = false;
    }
    if (!good) return std::nullopt;
  }
  return wish;
}

struct Input {
  std::string mesh;
  int triangles;
};
std::vector<Input> inputs_of(const Wish& wish, bool quick) {
  std::vector<std::string> meshes = wish.meshes;
  if (meshes.empty()) meshes = {"knot", "sphere", "tree"};
  std::vector<int> sizes = {8000};
  if (wish.meshes.empty()) sizes = {8000, 32000, 64000};
  if (wish.triangles) sizes = {*wish.triangles};
  if (quick) sizes = {500};
  std::vector<Input> inputs;
  for (const std::string& mesh : meshes) {
    for (const int triangles : sizes) inputs.push_back({mesh, triangles});
  }
  return inputs;
}

Cell measure(const Input& input, const TriangleMesh& mesh, int frames, const Wish& wish, const Effort& effort) {
  Cell cell{std::filesystem::path(input.mesh).stem().string(), mesh.triangles.size(), 0, 0, {}, {}};
  const std::vector<Frame> motion = make_motion(mesh, frames, wish.seed);
  for (const Frame& frame : motion) {
    for (const Query& query : frame.queries) {
      cell.touching += query.pairs > 0;
      cell.pairs += query.pairs;
    }
  }
  const auto busy = std::ranges::find_if(motion, [](const Frame& frame) { return !frame.queries.empty(); });
  if (busy != motion.end()) cell.first_answer_ms = first_answer_ms(peerd_lazily(), mesh, *busy);
  cell.scores = contest(mesh, motion, engines_of(wish), effort);
  return cell;
}

int run(const Options& options) {
  const auto wish = parse(options.arguments);
  if (!wish) {
    std::fprintf(stderr,
                 "usage: bench_peers [--mesh knot|sphere|tree|FILE] [--triangles N] [--seed S] [--frames F] "
                 "[--engines NAME,..] [--avx2] [--json] [--quick] [--out DIR] [--commit NAME] [FILE..]\n");
    return 2;
  }
  if (!wish->avx512) hwy::DisableTargets(HWY_AVX3 | HWY_AVX3_DL);
  const Effort effort = options.quick ? Effort{.rounds = 1, .timings = 1, .budget_s = 1} : Effort{};
  std::vector<Cell> cells;
  bool good = true;
  for (const Input& input : inputs_of(*wish, options.quick)) {
    const auto mesh = make_triangle_mesh(input.mesh, input.triangles, wish->seed);
    if (!mesh) {
      std::fprintf(stderr, "error: %s\n", mesh.error().c_str());
      return 2;
    }
    cells.push_back(measure(input, *mesh, options.quick ? 5 : wish->frames, *wish, effort));
    const Score& ours = cells.back().scores.front();
    if (const auto& ms = cells.back().first_answer_ms; ms && std::isnan(*ms)) good = false;
    good &= ours.disagreements * kQueriesADisagreement <= ours.queries;
    if (!wish->json) print_cell(cells.back());
  }
  if (wish->json) {
    std::printf("%s\n", to_json(cells).c_str());
  } else {
    print_summary(cells);
  }
  if (!write_figures(options, to_figures(cells))) return 3;
  if (!good) std::fprintf(stderr, "error: answers are wrong; see the first engine's\n");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench::peers

int main(int argc, char** argv) { return peerd::bench::peers::run(peerd::bench::parse_options(argc, argv)); }
