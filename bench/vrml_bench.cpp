// Question: how fast is reading a world, beside Coin and beside our own tokenizer, and how much memory does it take?
//
// vrml_bench [--quick] [--out DIR] [--commit NAME] [FILE..]: the worlds of vrml_worlds.hpp, all VRML 2.0 files over 1
// MB in $PEERD_CORPUS/vrml, and the FILEs. Texts are in memory and unpacked before anything is timed.
//
//   read        read_world(), and what it made freed
//   fresh       the same with memory that the kernel gives anew, page by page, as to a program that reads one world. In
//               all others the allocator keeps what it once had, for Coin too
//   tokens      the Lexer over all tokens, every number token converted: what no reader with this lexer can do without
//   from_chars  std::from_chars over all numbers, one blank apart: what no conversion by the library can do without
//   coin        SoInput::setBuffer, SoDB::readAll, unref
//
// They take turns, each round in the opposite order of the last, so that what else the machine does meets them all.
// Times are the processor's, of one thread and the kernel for it: whoever else runs only makes waits. Ratios are of
// medians. Memory is what operator new gave (heap_meter.hpp): the peak within read_world(), and what the
// result holds. Exit code 1: an answer is wrong, or the peak, which no other program can disturb, is over its target.
#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "coin_reader.hpp"
#include "core/geometry/mesh.hpp"
#include "core/scene/reader.hpp"
#include "core/scene/scene_statistics.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/gzip.hpp"
#include "core/vrml/lexer.hpp"
#include "figures.hpp"
#include "heap_meter.hpp"
#include "vrml_worlds.hpp"

namespace peerd::bench {
namespace {

constexpr double kMaxReadToTokens = 2.5;
constexpr double kMinCoinToRead = 5;
constexpr double kMaxPeakToResult = 2;
constexpr std::size_t kLargeFile = 1'000'000;  // bytes; shorter times say little
constexpr std::size_t kMaxFile = std::size_t{1} << 30;

struct Input {
  TextWorld world;
  bool generated = false;  // then the counts in `world` are known
};

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
double seconds_since(double begin) { return cpu_seconds() - begin; }

// Inputs

std::optional<std::string> read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (!file && !file.eof()) return std::nullopt;
  if (!is_gzip(text)) return text;
  auto unpacked = gunzip(text, kMaxFile);
  if (!unpacked) return std::nullopt;
  return std::move(*unpacked);
}

std::vector<Input> corpus() {
  const char* const folder = std::getenv("PEERD_CORPUS");
  if (folder == nullptr) return {};
  std::set<std::filesystem::path> paths;  // in an order that is the same everywhere
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(folder) / "vrml", error)) {
    const auto extension = entry.path().extension();
    if (extension == ".wrl" || extension == ".wrz" || extension == ".gz") paths.insert(entry.path());
  }
  if (error) std::fprintf(stderr, "warning: no files in PEERD_CORPUS/vrml: %s\n", error.message().c_str());
  std::vector<Input> inputs;
  for (const auto& path : paths) {
    auto text = read_file(path);
    if (!text || text->size() <= kLargeFile || !vrml::read_header(*text)) continue;
    inputs.push_back({{path.stem().string(), std::move(*text)}});
  }
  return inputs;
}

// This section holds the functions that are timed.

struct Tokens {
  std::size_t numbers = 0;
  double sum = 0;
};

Tokens tokenize(std::string_view text, std::size_t begin) {
  vrml::Lexer lexer(text, begin);
  Tokens tokens;
  for (vrml::Token token = lexer.next(); token.kind != vrml::TokenKind::kEnd; token = lexer.next()) {
    if (token.kind != vrml::TokenKind::kNumber) continue;
    const auto value = vrml::read_float(token.text);
    if (!value) continue;  // 0x.. and what is none
    ++tokens.numbers;
    tokens.sum += static_cast<double>(*value);
  }
  return tokens;
}

// The numbers that tokenize() finds, without a plus, each with a blank behind it.
std::string spellings(std::string_view text, std::size_t begin) {
  vrml::Lexer lexer(text, begin);
  std::string out;
  for (vrml::Token token = lexer.next(); token.kind != vrml::TokenKind::kEnd; token = lexer.next()) {
    if (token.kind != vrml::TokenKind::kNumber || !vrml::read_float(token.text)) continue;
    out += token.text.substr(token.text.starts_with('+') ? 1 : 0);
    out += ' ';
  }
  return out;
}

Tokens convert(std::string_view numbers) {
  Tokens tokens;
  for (const char *at = numbers.data(), *const end = at + numbers.size(); at < end;) {
    float value = 0;  // of what is too small to be any other
    at = std::from_chars(at, end, value).ptr + 1;
    ++tokens.numbers;
    tokens.sum += static_cast<double>(value);
  }
  return tokens;
}

// Why a count of triangles need not be Coin's: what they tessellate or show in other ways. Empty where it must.
std::string incomparable(const Scene& scene) {
  for (const vrml::Node& node : scene.document->nodes) {
    const std::string_view type = node.type->name;
    for (const std::string_view other :
         {"LOD", "Switch", "Collision", "Inline", "Sphere", "Cone", "Cylinder", "ElevationGrid", "Extrusion", "Text"}) {
      if (type == other) return std::string(other);
    }
    if (type == "IndexedFaceSet" && !vrml::value_of(node, "convex").as<bool>()[0]) return "convex FALSE";
  }
  for (const Geometry& geometry : scene.geometries) {
    const auto* const faces = std::get_if<FaceSetGeometry>(&geometry);
    if (faces == nullptr) continue;
    std::size_t corners = 0;
    for (const std::int32_t corner : faces->corners) {
      if (corner == Mesh::kEndOfPolygon && corners > 0 && corners < 3) return "polygons of < 3 corners";
      corners = corner == Mesh::kEndOfPolygon ? 0 : corners + 1;
    }
  }
  return {};
}

// Results

struct Memory {
  double peak = 0, result = 0, text = 0;  // bytes
  std::size_t allocations = 0;
};

struct Result {
  std::string name;
  Memory memory;
  Quartiles read, read_and_free, fresh, tokens, from_chars;  // [s]; `read` is without freeing
  std::optional<Quartiles> coin;
  SceneStatistics counts;
  std::optional<std::uint64_t> coin_triangles;
  std::string not_compared;  // with Coin's, and why
  std::vector<std::string> wrong;

  [[nodiscard]] double read_to_tokens() const { return read_and_free.median / tokens.median; }
  [[nodiscard]] double tokens_to_from_chars() const { return tokens.median / from_chars.median; }
  [[nodiscard]] std::optional<double> coin_to_read() const {
    return coin ? std::optional(coin->median / read_and_free.median) : std::nullopt;
  }
  [[nodiscard]] double peak_to_result() const { return memory.peak / memory.result; }
  [[nodiscard]] double mb_per_s() const { return memory.text / 1e6 / read_and_free.median; }
};

void check_answers(const Input& input, Result& result) {
  const std::string_view text = input.world.text;
  const ReadResult read = read_world(text);
  if (!read.scene) {
    for (const Diagnostic& d : read.diagnostics) {
      if (d.severity == Severity::kError) return result.wrong.push_back("no scene: " + d.message);
    }
  }
  result.counts = statistics_of(*read.scene);
  if (input.generated) {
    if (result.counts.polygons_instanced != input.world.polygons) result.wrong.emplace_back("polygons");
    if (result.counts.triangles_instanced != input.world.triangles) result.wrong.emplace_back("triangles");
  }
  result.not_compared = incomparable(*read.scene);
  result.coin_triangles = triangles_of_coin(text);
  if (!result.coin_triangles) result.not_compared = "Coin reads it not";
  const bool equal = result.coin_triangles == result.counts.triangles_instanced;
  if (result.not_compared.empty() && !equal) result.wrong.emplace_back("triangles, by Coin");
}

void measure_memory(std::string_view text, Result& result) {
  const HeapMeter meter;
  const ReadResult read = read_world(text);
  result.memory = {.peak = static_cast<double>(meter.peak()),
                   .result = static_cast<double>(meter.live()),
                   .text = static_cast<double>(text.size()),
                   .allocations = meter.allocations()};
}

void measure_times(std::string_view text, std::size_t rounds, bool with_coin, Result& result) {
  const std::size_t begin = vrml::read_header(text)->end;
  const std::string numbers = spellings(text, begin);
  const Tokens expected = convert(numbers);
  std::vector<double> read, read_and_free, fresh, tokens, from_chars, coin;
  std::vector<std::string> wrong;
  const auto same = [&](const Tokens& t) { return t.numbers == expected.numbers && t.sum == expected.sum; };
  enum Turn : std::size_t { kRead, kFresh, kTokens, kFromChars, kCoin, kTurns };
  const auto take_turn = [&](std::size_t turn) {
    if (turn == kFresh) malloc_trim(0);
    const double start = cpu_seconds();
    bool good = true;
    switch (turn) {
      case kRead: {
        auto result_of_read = std::optional(read_world(text));
        read.push_back(seconds_since(start));
        good = result_of_read->scene.has_value();
        result_of_read.reset();
        read_and_free.push_back(seconds_since(start));
        break;
      }
      case kFresh:
        good = read_world(text).scene.has_value();
        fresh.push_back(seconds_since(start));
        break;
      case kTokens:
        good = same(tokenize(text, begin));
        tokens.push_back(seconds_since(start));
        break;
      case kFromChars:
        good = same(convert(numbers));
        from_chars.push_back(seconds_since(start));
        break;
      default:
        if (!with_coin) return;
        good = read_with_coin(text);
        coin.push_back(seconds_since(start));
    }
    if (!good) wrong.push_back("turn " + std::to_string(turn));
  };
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t turn = 0; turn < kTurns; ++turn) take_turn(round % 2 == 0 ? turn : kTurns - 1 - turn);
  }
  result.read = quartiles(read);
  result.read_and_free = quartiles(read_and_free);
  result.fresh = quartiles(fresh);
  result.tokens = quartiles(tokens);
  result.from_chars = quartiles(from_chars);
  if (!coin.empty()) result.coin = quartiles(coin);
  result.wrong.insert(result.wrong.end(), wrong.begin(), wrong.end());
}

Result measure(const Input& input, bool quick) {
  Result result;
  result.name = input.world.name;
  check_answers(input, result);
  if (!result.wrong.empty()) return result;
  measure_memory(input.world.text, result);
  measure_times(input.world.text, quick ? 2 : 11, result.coin_triangles.has_value(), result);
  return result;
}

void add_figures(const Result& r, std::vector<Figure>& figures) {
  const auto name = [&](const char* what) { return r.name + '.' + what; };
  const auto time = [&](const char* what, const Quartiles& q, const char* against, std::optional<double> ratio) {
    figures.push_back(
        {name(what), q.median * 1e3, "ms", *against == 0 ? "" : name(against), ratio, q.low * 1e3, q.high * 1e3});
  };
  time("read", r.read_and_free, "tokens", r.read_to_tokens());
  time("read_not_freed", r.read, "tokens", r.read.median / r.tokens.median);
  time("read_fresh", r.fresh, "tokens", r.fresh.median / r.tokens.median);
  time("tokens", r.tokens, "from_chars", r.tokens_to_from_chars());
  time("from_chars", r.from_chars, "", std::nullopt);
  if (r.coin) time("coin", *r.coin, "read", r.coin_to_read());
  const auto plain = [&](const char* what, double value, const char* unit, std::string against = {},
                         std::optional<double> ratio = {}) {
    figures.push_back({name(what), value, unit, std::move(against), ratio, value, value});
  };
  plain("text", r.memory.text, "B");
  plain("read_speed", r.mb_per_s(), "MB/s");
  plain("peak", r.memory.peak, "B", name("result"), r.peak_to_result());
  plain("peak_by_text", r.memory.peak, "B", name("text"), r.memory.peak / r.memory.text);
  plain("result", r.memory.result, "B", name("text"), r.memory.result / r.memory.text);
  plain("allocations", static_cast<double>(r.memory.allocations), "1");
  plain("polygons", static_cast<double>(r.counts.polygons_instanced), "1");
  const auto triangles = static_cast<double>(r.counts.triangles_instanced);
  if (r.not_compared.empty()) {
    plain("triangles", triangles, "1", "Coin's", triangles / static_cast<double>(*r.coin_triangles));
  } else {
    plain("triangles", triangles, "1");
  }
}

void print_head() {
  std::printf("%-28s %6s %8s %8s %7s %8s %8s %9s %7s %7s %7s %8s %8s %6s %6s %9s  %s\n", "world", "MB", "read ms",
              "fresh", "MB/s", "tokens", "from_ch", "coin ms", "rd/tok", "tok/fch", "coin/rd", "peak MB", "resultMB",
              "pk/res", "pk/txt", "triangles", "Coin's");
}

void print(const Result& r) {
  const auto ms = [](const Quartiles& q) { return q.median * 1e3; };
  std::printf("%-28.28s ", r.name.c_str());
  if (!r.wrong.empty()) {
    std::printf("WRONG:");
    for (const std::string& w : r.wrong) std::printf(" %s;", w.c_str());
    std::printf("\n");
    return;
  }
  std::printf("%6.2f %8.2f %8.2f %7.1f %8.2f %8.2f ", r.memory.text / 1e6, ms(r.read_and_free), ms(r.fresh),
              r.mb_per_s(), ms(r.tokens), ms(r.from_chars));
  if (r.coin) {
    std::printf("%9.1f %7.2f %7.2f %7.1f ", ms(*r.coin), r.read_to_tokens(), r.tokens_to_from_chars(),
                *r.coin_to_read());
  } else {
    std::printf("%9s %7.2f %7.2f %7s ", "-", r.read_to_tokens(), r.tokens_to_from_chars(), "-");
  }
  std::printf(
      "%8.2f %8.2f %6.2f %6.2f %9llu  %s\n", r.memory.peak / 1e6, r.memory.result / 1e6, r.peak_to_result(),
      r.memory.peak / r.memory.text, static_cast<unsigned long long>(r.counts.triangles_instanced),
      r.not_compared.empty()
          ? "equal"
          : ((r.coin_triangles ? std::to_string(*r.coin_triangles) : "-") + " (" + r.not_compared + ")").c_str());
  std::fflush(stdout);
}

// Prints whether the worst of all meets the target.
bool judge(const char* what, const std::vector<Result>& results, bool at_most, double target, auto ratio_of) {
  const Result* worst = nullptr;
  double worst_ratio = 0;
  for (const Result& r : results) {
    const std::optional<double> ratio =
        r.wrong.empty() ? static_cast<std::optional<double>>(ratio_of(r)) : std::nullopt;
    if (!ratio) continue;
    if (worst != nullptr && (at_most ? *ratio <= worst_ratio : *ratio >= worst_ratio)) continue;
    worst = &r;
    worst_ratio = *ratio;
  }
  if (worst == nullptr) return true;
  const bool met = at_most ? worst_ratio <= target : worst_ratio >= target;
  std::printf("%s %s %g: %s, worst %.2f (%s)\n", what, at_most ? "<=" : ">=", target, met ? "met" : "MISSED",
              worst_ratio, worst->name.c_str());
  return met;
}

int run(const Options& options) {
  std::vector<Input> inputs;
  for (TextWorld& world : make_worlds(options.quick)) inputs.push_back({std::move(world), true});
  if (!options.quick) {
    for (Input& input : corpus()) inputs.push_back(std::move(input));
  }
  for (const std::string& file : options.arguments) {
    auto text = read_file(file);
    if (!text || !vrml::read_header(*text)) {
      std::fprintf(stderr, "error: %s cannot be read, or is no VRML 2.0 file\n", file.c_str());
      return 2;
    }
    inputs.push_back({{std::filesystem::path(file).stem().string(), std::move(*text)}});
  }
  // The allocator's own thresholds move with what was freed last, and with them who pays for page faults.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  start_coin();
  static_cast<void>(read_world(make_worlds(true).front().text));  // what is made once, at first use

  std::vector<Result> results;
  std::vector<Figure> figures;
  bool good = true;
  print_head();
  for (const Input& input : inputs) {
    results.push_back(measure(input, options.quick));
    print(results.back());
    good = good && results.back().wrong.empty();
    if (results.back().wrong.empty()) add_figures(results.back(), figures);
  }
  if (!options.quick) {  // tiny worlds say nothing
    judge("read / tokens", results, true, kMaxReadToTokens, [](const Result& r) { return r.read_to_tokens(); });
    judge("coin / read", results, false, kMinCoinToRead, [](const Result& r) { return r.coin_to_read(); });
    good &= judge("peak / result", results, true, kMaxPeakToResult, [](const Result& r) { return r.peak_to_result(); });
  }
  if (!write_figures(options, figures)) return 3;
  if (!good) std::fprintf(stderr, "error: an answer is wrong, or the peak is over its target; see above\n");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
