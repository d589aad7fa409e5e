#include "peerd/cli/commands/collide_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "collision/engines/engine.hpp"
#include "collision/engines/engine_watch.hpp"
#include "collision/engines/wrong_answers.hpp"
#include "collision/scene/collision_watch.hpp"
#include "collision/scene/scene_query.hpp"
#include "core/motion/scene_motion.hpp"
#include "core/scene/interest_pairs.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/cli/shell/world_time_progress.hpp"
#include "peerd/input/hierarchy_files.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;
using collision::engines::Engine;
using collision::engines::EngineWatch;
using collision::engines::WrongAnswers;

collision::BoxBound box_bound(const CollideOptions& options) {
  return options.realigned_boxes ? collision::BoxBound::kRealigned : collision::BoxBound::kVertices;
}

// Brings a SceneQuery to a world time.
void go_to(collision::SceneQuery& query, SceneMotion& motion, double t_s) {
  query.set_transforms(motion.transforms_at(t_s));
  for (const SceneMotion::MovedGeometry& moved : motion.moved_geometries(t_s)) query.reshape(moved.index, moved.form);
}

// How often the engine was wrong about each interest, by CollideOptions::against.
struct Comparison {
  std::vector<WrongAnswers> of_interests;  // in the order of the answers

  [[nodiscard]] WrongAnswers total() const {
    WrongAnswers sum;
    for (const WrongAnswers& each : of_interests) sum.add(each);
    return sum;
  }
};

Json to_json(const WrongAnswers& wrong) {
  return {{"questions", wrong.questions}, {"false_touches", wrong.false_touches}, {"missed", wrong.missed}};
}

Json to_json(const Scene& scene, const std::string& against, const Comparison& comparison,
             std::span<const collision::WatchedInterest> interests) {
  Json json = {{"engine", against}};
  json.update(to_json(comparison.total()));
  json["interests"] = Json::array();
  for (std::size_t i = 0; i < interests.size(); ++i) {
    Json each = {{"collider", scene.path_of(interests[i].collider)},
                 {"collidee", scene.path_of(interests[i].collidee)},
                 {"type", name_of(interests[i].type)}};
    each.update(to_json(comparison.of_interests[i]));
    json["interests"].push_back(std::move(each));
  }
  return json;
}

std::string sentence(const WrongAnswers& wrong) {
  return counted(wrong.false_touches, "false touch", "false touches") + ", " + std::to_string(wrong.missed) +
         " missed, of " + counted(wrong.questions, "answer");
}

// A line for each interest with a wrong answer, and one of all.
void print_text(const Scene& scene, const std::string& against, const Comparison& comparison,
                std::span<const collision::WatchedInterest> interests, std::ostream& out) {
  for (std::size_t i = 0; i < interests.size(); ++i) {
    const WrongAnswers& wrong = comparison.of_interests[i];
    if (wrong.wrong() == 0) continue;
    out << scene.path_of(interests[i].collider) << " - " << scene.path_of(interests[i].collidee) << " ("
        << name_of(interests[i].type) << "): " << sentence(wrong) << '\n';
  }
  out << "against " << against << ": " << sentence(comparison.total()) << '\n';
}

struct Answer {
  collision::WatchedInterest interest;
  collision::Collision collision{};
};

Json to_json(const Scene& scene, const collision::ShapePolygon& p) { return {scene.path_of(p.shape), p.polygon}; }

Json to_json(const Scene& scene, const Answer& answer) {
  Json pairs = Json::array();
  for (const collision::ShapePair& pair : answer.collision.pairs) {
    pairs.push_back({{"a", to_json(scene, pair.collider)}, {"b", to_json(scene, pair.collidee)}});
  }
  return {{"collider", scene.path_of(answer.interest.collider)},
          {"collidee", scene.path_of(answer.interest.collidee)},
          {"type", name_of(answer.interest.type)},
          {"colliding", answer.collision.colliding},
          {"pairs", std::move(pairs)}};
}

Json to_json(const collision::SceneQueryCounters& counters) {
  return {{"hierarchies_built", counters.hierarchies_built},
          {"nodes_built", counters.nodes_built},
          {"bv_tests", counters.queries.bv_tests},
          {"polygon_tests", counters.queries.triangle_tests},
          {"exact_tests", counters.queries.orientation.exact}};
}

void print_text(const Scene& scene, const Answer& answer, std::ostream& out) {
  constexpr std::size_t kShown = 20;  // pairs of an interest that are printed
  out << scene.path_of(answer.interest.collider) << " - " << scene.path_of(answer.interest.collidee) << " ("
      << name_of(answer.interest.type) << "): " << (answer.collision.colliding ? "colliding" : "apart");
  const auto& pairs = answer.collision.pairs;
  if (answer.interest.type == CollisionType::kAllPairs) out << ", " << counted(pairs.size(), "pair") << " of polygons";
  out << '\n';
  for (std::size_t i = 0; i < std::min(kShown, pairs.size()); ++i) {
    const auto& [a, b] = pairs[i];
    out << "  " << scene.path_of(a.shape) << " polygon " << a.polygon << " - " << scene.path_of(b.shape) << " polygon "
        << b.polygon << '\n';
  }
  if (pairs.size() > kShown) out << "  .. and " << pairs.size() - kShown << " more\n";
}

Json to_json(const Scene& scene, double time_s, const char* event, const collision::WatchedInterest& interest) {
  return {{"time_s", time_s},
          {"event", event},
          {"collider", scene.path_of(interest.collider)},
          {"collidee", scene.path_of(interest.collidee)},
          {"type", name_of(interest.type)}};
}

// Reports one tick as lines, or as elements of `events`.
void report_tick(const Scene& scene, double time_s, const collision::CollisionWatch& watch,
                 const collision::CollisionWatch::Tick& tick, bool json, Json& events, std::ostream& out) {
  const auto report = [&](const char* event, std::uint32_t i) {
    const collision::WatchedInterest& interest = watch.interests()[i];
    if (json) {
      events.push_back(to_json(scene, time_s, event, interest));
    } else {
      out << time_s << " s: " << scene.path_of(interest.collider) << " - " << scene.path_of(interest.collidee) << " ("
          << name_of(interest.type) << ") " << event << '\n';
    }
  };
  for (const std::uint32_t i : tick.ended) report("ended", i);
  for (const std::uint32_t i : tick.began) report("began", i);
  for (const auto& [object, value] : tick.not_colliding) {
    if (json) {
      events.push_back(
          {{"time_s", time_s}, {"event", "notColliding"}, {"object", scene.path_of(object)}, {"value", value}});
    } else {
      out << time_s << " s: " << scene.path_of(object) << " notColliding " << (value ? "TRUE" : "FALSE") << '\n';
    }
  }
}

// The error before the first tick, if any.
std::optional<InputError> why_no_ticks(const CollideOptions& options) {
  if (*options.until_s < options.at_s) {
    return InputError{fmt::format("error: --until {} is before --at {}: there is no tick between them",
                                  *options.until_s, options.at_s)};
  }
  const double far_s = std::max(std::abs(options.at_s), std::abs(*options.until_s));
  if (far_s + 1.0 / options.hz > far_s) return std::nullopt;
  return InputError{fmt::format("error: at {} s a tick of 1/{} s is lost in rounding; lower --hz", far_s, options.hz)};
}

// Bodies that answer contacts do so in a session alone. The result is empty where the world has none.
std::vector<std::string> warnings_about(const Scene& scene) {
  std::string names;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (!scene.object(scene.id_of(i)).response) continue;
    if (++count <= kShownProblems) names += (count == 1 ? "" : ", ") + scene.path_of(scene.id_of(i));
  }
  if (count == 0) return {};
  if (count > kShownProblems) names += fmt::format(" and {} more", count - kShownProblems);
  return {"collide moves things through what they meet, also " + names + ", with a CollisionResponse; peerd sim and " +
          "peerd run answer contacts"};
}

// The findings of a watch, and how far it has come.
struct Watched {
  std::uint64_t ticks = 0;
  bool interrupted = false;
  Json events = Json::array();
  Comparison comparison;             // with CollideOptions::against
  std::vector<double> asked_micros;  // by tick at which a pair of objects was asked
};

Json to_json(std::vector<double> micros) {
  double sum = 0.0;
  for (const double each : micros) sum += each;
  const std::size_t count = micros.size();
  std::ranges::sort(micros);
  return {{"ticks", count},
          {"mean", count == 0 ? 0.0 : sum / static_cast<double>(count)},
          {"median", count == 0 ? 0.0 : micros[count / 2]},
          {"greatest", count == 0 ? 0.0 : micros.back()}};
}

Json to_json(const std::string& path, const CollideOptions& options, Watched& watched,
             const std::vector<std::string>& warnings, const collision::CollisionWatchCounters& counters,
             double micros) {
  Json counted = to_json(counters.query);
  counted.update({{"box_tests", counters.broad.box_tests},
                  {"pairs_postponed", counters.pairs_postponed},
                  {"pairs_far", counters.pairs_far},
                  {"pairs_unmoved", counters.pairs_unmoved},
                  {"pairs_separated", counters.pairs_separated},
                  {"pairs_asked", counters.pairs_queried},
                  {"pairs_witnessed", counters.shapes.pairs_witnessed},
                  {"pairs_tested", counters.shapes.pairs_tested}});
  Json json = {{"world", path},
               {"time_s", options.at_s},
               {"until_s", *options.until_s},
               {"hz", options.hz},
               {"ticks", watched.ticks},
               {"tick_micros", to_json(std::move(watched.asked_micros))},
               {"events", std::move(watched.events)},
               {"counters", std::move(counted)},
               {"micros", micros},
               {"warnings", warnings}};
  if (options.engine != CollideOptions{}.engine) json["engine"] = options.engine;
  if (watched.interrupted) json["partial"] = true;
  return json;
}

// Goes from tick to tick and reports each; `against`: null, or what the answers are compared with. The error ends it.
Result<Watched> watch_ticks(const std::string& path, const Scene& scene, const CollideOptions& options,
                            EngineWatch& engine, EngineWatch* against, std::ostream& out) {
  WorldTimeProgress progress(options.progress, options.at_s, *options.until_s);
  Watched watched;
  const collision::CollisionWatch& watch = engine.watch();
  if (against != nullptr) watched.comparison.of_interests.resize(watch.interests().size());
  for (;; ++watched.ticks) {
    const double time_s = options.at_s + static_cast<double>(watched.ticks) / options.hz;
    if (time_s > *options.until_s) break;
    watched.interrupted = options.interrupted && options.interrupted();
    if (watched.interrupted) break;
    progress.show(time_s);
    const std::uint64_t asked = watch.counters().pairs_queried;
    const auto start = std::chrono::steady_clock::now();
    const collision::CollisionWatch::Tick& tick = engine.tick(time_s);
    const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
    if (watch.counters().pairs_queried > asked) watched.asked_micros.push_back(micros.count());
    if (!tick.refused.empty() || !tick.ended.empty() || !tick.began.empty() || !tick.not_colliding.empty()) {
      progress.hide();
    }
    if (!tick.refused.empty())
      return std::unexpected(InputError{path + ": error: " + tick.refused.front().why, kFinding});
    report_tick(scene, time_s, watch, tick, options.json, watched.events, out);
    if (against == nullptr) continue;
    const auto& right = against->tick(time_s);
    if (!right.refused.empty())
      return std::unexpected(InputError{path + ": error: " + right.refused.front().why, kFinding});
    for (std::uint32_t i = 0; i < watch.interests().size(); ++i) {
      watched.comparison.of_interests[i].count(watch.is_colliding(i), against->watch().is_colliding(i));
    }
  }
  progress.hide();
  return watched;
}

// A world's hierarchyFiles are those of our trees.
collision::HierarchyLoader loader_for(const std::string& path, const Engine& engine) {
  return engine.narrow_phase == nullptr ? mapped_hierarchies(path) : collision::HierarchyLoader{};
}

int watch_collisions(const std::string& path, const Scene& scene, const CollideOptions& options, const Engine& engine,
                     const Engine* right, std::ostream& out, std::ostream& err) {
  std::ostream* const json = options.json ? &out : nullptr;
  if (const auto error = why_no_ticks(options)) return print_error(*error, err, json);
  const std::vector<std::string> warnings = warnings_about(scene);
  for (const std::string& warning : warnings) err << path << ": warning: " << warning << '\n';
  const auto start = std::chrono::steady_clock::now();
  EngineWatch engine_watch(scene, engine, loader_for(path, engine), box_bound(options));
  std::optional<EngineWatch> against;
  if (right != nullptr) against.emplace(scene, *right, loader_for(path, *right), box_bound(options));
  auto watched = watch_ticks(path, scene, options, engine_watch, against ? &*against : nullptr, out);
  if (!watched) return print_error(watched.error(), err, json);
  const collision::CollisionWatch& watch = engine_watch.watch();
  for (const std::string& note : watch.notes()) err << path << ": note: " << note << '\n';
  if (watched->interrupted) {
    err << fmt::format("interrupted after {}: the results are partial, none is later than {} s\n",
                       counted(watched->ticks, "tick"),
                       options.at_s + (static_cast<double>(watched->ticks) - 1.0) / options.hz);
  }
  const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
  const collision::CollisionWatchCounters counters = watch.counters();
  if (options.json) {
    Json json_out = to_json(path, options, *watched, warnings, counters, micros.count());
    if (against) json_out["against"] = to_json(scene, *options.against, watched->comparison, watch.interests());
    out << json_text(json_out) << '\n';
  } else {
    if (against) print_text(scene, *options.against, watched->comparison, watch.interests(), out);
    out << (watched->interrupted ? "partial: " : "") << counted(watched->ticks, "tick") << "; pairs of objects: ";
    if (counters.pairs_postponed > 0) out << counters.pairs_postponed << " postponed, ";
    out << counters.pairs_far << " far, " << counters.pairs_unmoved << " unmoved, " << counters.pairs_separated
        << " separated, " << counters.pairs_queried << " asked; of Shapes: " << counters.shapes.pairs_witnessed
        << " touching where they did, " << counters.shapes.pairs_tested << " tested; " << micros.count() << " us\n";
  }
  return watched->interrupted ? kInterrupted : 0;
}

// Answers to all interests, in file order; the error is that of the first that has none.
Result<std::vector<Answer>> answers_of(const std::string& path, const Scene& scene, const CollideOptions& options,
                                       collision::SceneQuery& query, const Engine& engine) {
  query.set_narrow_phase(engine.narrow_phase.get());
  query.set_box_bound(box_bound(options));
  SceneMotion motion(scene);
  go_to(query, motion, options.at_s);
  std::vector<Answer> answers;
  for (const CollisionInterest& interest : scene.interests) {
    std::optional<std::string> error;
    InterestPairs(scene, interest).for_each([&](ObjectId collider, ObjectId collidee) {
      if (error) return;
      auto collision = query.collide(collider, collidee, interest.type);
      if (collision) {
        answers.push_back({{collider, collidee, interest.type}, std::move(*collision)});
      } else {
        error = collision.error();
      }
    });
    if (error) return std::unexpected(InputError{path + ": error: " + *error, kFinding});
  }
  return answers;
}

int ask_once(const std::string& path, const Scene& scene, const CollideOptions& options, const Engine& engine,
             const Engine* right, std::ostream& out, std::ostream& err) {
  std::ostream* const json_errors = options.json ? &out : nullptr;
  const auto start = std::chrono::steady_clock::now();
  collision::SceneQuery query(scene, loader_for(path, engine));
  const auto answers = answers_of(path, scene, options, query, engine);
  if (!answers) return print_error(answers.error(), err, json_errors);
  for (const std::string& note : query.notes()) err << path << ": note: " << note << '\n';
  const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
  const collision::SceneQueryCounters counters = query.counters();
  Comparison comparison;
  std::vector<collision::WatchedInterest> interests;
  if (right != nullptr) {
    collision::SceneQuery other(scene, loader_for(path, *right));
    const auto right_answers = answers_of(path, scene, options, other, *right);
    if (!right_answers) return print_error(right_answers.error(), err, json_errors);
    for (std::size_t i = 0; i < answers->size(); ++i) {
      interests.push_back((*answers)[i].interest);
      comparison.of_interests.emplace_back().count((*answers)[i].collision.colliding,
                                                   (*right_answers)[i].collision.colliding);
    }
  }
  if (options.json) {
    Json of_interests = Json::array();
    for (const Answer& answer : *answers) of_interests.push_back(to_json(scene, answer));
    Json json = {{"world", path},
                 {"time_s", options.at_s},
                 {"interests", std::move(of_interests)},
                 {"counters", to_json(counters)},
                 {"micros", micros.count()}};
    if (options.engine != CollideOptions{}.engine) json["engine"] = options.engine;
    if (right != nullptr) json["against"] = to_json(scene, *options.against, comparison, interests);
    out << json_text(json) << '\n';
    return 0;
  }
  for (const Answer& answer : *answers) print_text(scene, answer, out);
  if (right != nullptr) print_text(scene, *options.against, comparison, interests, out);
  out << counted(answers->size(), "interest") << "; " << counted(counters.hierarchies_built, "hierarchy", "hierarchies")
      << " of " << counted(counters.nodes_built, "node") << "; tests: " << counters.queries.bv_tests
      << " of bounding volumes, " << counters.queries.triangle_tests << " of polygons, "
      << counters.queries.orientation.exact << " in exact arithmetic; " << micros.count() << " us\n";
  return 0;
}

}  // namespace

int list_engines(bool json, std::ostream& out) {
  Json list = Json::array();
  for (const auto& [name, is_exact, reference, about] : collision::engines::engines()) {
    list.push_back({{"name", name}, {"exact", is_exact}, {"reference", reference}, {"about", about}});
    if (!json) out << fmt::format("{:<12} {} ({}; {})\n", name, about, is_exact ? "exact" : "approximate", reference);
  }
  if (json) out << json_text(list) << '\n';
  return 0;
}

int run_collide(const std::string& path, const CollideOptions& options, std::ostream& out, std::ostream& err) {
  std::ostream* const json_errors = options.json ? &out : nullptr;
  const auto file = open_world(path, options.reading, err, json_errors);
  if (!file) return file.error();
  const Scene& scene = *(*file)->result.scene;
  const auto engine = collision::engines::make_engine(options.engine);
  if (!engine) return print_error({"error: --engine: " + engine.error()}, err, json_errors);
  const auto right = collision::engines::make_engine(options.against.value_or("ours"));
  if (!right) return print_error({"error: --against: " + right.error()}, err, json_errors);
  if (!engine->description.is_exact) {
    err << path << ": warning: the engine " << engine->description.name << " is not exact: near is taken for a touch\n";
  }
  if (options.until_s) {
    return watch_collisions(path, scene, options, *engine, options.against ? &*right : nullptr, out, err);
  }
  return ask_once(path, scene, options, *engine, options.against ? &*right : nullptr, out, err);
}

}  // namespace peerd
