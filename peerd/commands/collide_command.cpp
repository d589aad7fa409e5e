#include "peerd/commands/collide_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "collision/baselines/engine.hpp"
#include "collision/scene/collision_watch.hpp"
#include "collision/scene/scene_query.hpp"
#include "core/motion/scene_motion.hpp"
#include "peerd/commands/problems.hpp"
#include "peerd/input/hierarchy_files.hpp"
#include "peerd/input/printable.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;
using collision::baselines::Engine;

collision::BoxBound box_bound(const CollideOptions& options) {
  return options.realigned_boxes ? collision::BoxBound::kRealigned : collision::BoxBound::kVertices;
}

// Brings a SceneQuery or a CollisionWatch to a world time.
template <class Target>
void go_to(Target& target, SceneMotion& motion, double t_s) {
  target.set_transforms(motion.transforms_at(t_s));
  for (SceneMotion::MovedGeometry& moved : motion.moved_geometries(t_s)) {
    target.reshape(moved.index, std::move(moved.form));
  }
}

struct Answer {
  ObjectId collider, collidee;
  CollisionType type = CollisionType::kBox;
  collision::Collision collision{};
};

Json to_json(const Scene& scene, const collision::ShapePolygon& p) { return {scene.path_of(p.shape), p.polygon}; }

Json to_json(const Scene& scene, const Answer& answer) {
  Json pairs = Json::array();
  for (const collision::ShapePair& pair : answer.collision.pairs) {
    pairs.push_back({{"a", to_json(scene, pair.collider)}, {"b", to_json(scene, pair.collidee)}});
  }
  return {{"collider", scene.path_of(answer.collider)},
          {"collidee", scene.path_of(answer.collidee)},
          {"type", name_of(answer.type)},
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
  out << scene.path_of(answer.collider) << " - " << scene.path_of(answer.collidee) << " (" << name_of(answer.type)
      << "): " << (answer.collision.colliding ? "colliding" : "apart");
  const auto& pairs = answer.collision.pairs;
  if (answer.type == CollisionType::kAllPairs) out << ", " << counted(pairs.size(), "pair") << " of polygons";
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

// Shows how far a long watch has come, and an estimate of what is left, on a terminal's last line.
class Progress {
 public:
  Progress(std::ostream* terminal, const CollideOptions& options)
      : terminal_(terminal), begin_s_(options.at_s), end_s_(*options.until_s) {}

  void show(double time_s) {
    if (terminal_ == nullptr) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < kPeriod) return;
    shown_ = now;
    const double taken_s = std::chrono::duration<double>(now - start_).count();
    const double left_s = taken_s * (end_s_ - time_s) / std::max(time_s - begin_s_, 1e-9);
    *terminal_ << fmt::format("\r\033[K{:.3f} s of {:.3f} s; about {:.0f} s left; Ctrl-C ends it", time_s, end_s_,
                              left_s)
               << std::flush;
    visible_ = true;
  }
  // Events are printed to the same terminal.
  void hide() {
    if (visible_) *terminal_ << "\r\033[K" << std::flush;
    visible_ = false;
  }

 private:
  static constexpr std::chrono::milliseconds kPeriod{500};

  std::ostream* terminal_;
  double begin_s_, end_s_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), shown_ = start_;
  bool visible_ = false;
};

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
};

Json to_json(const std::string& path, const CollideOptions& options, Watched& watched,
             const std::vector<std::string>& warnings, const collision::CollisionWatchCounters& counters,
             double micros) {
  Json counted = to_json(counters.query);
  counted.update({{"pairs_far", counters.pairs_far},
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
               {"events", std::move(watched.events)},
               {"counters", std::move(counted)},
               {"micros", micros},
               {"warnings", warnings}};
  if (options.engine != CollideOptions{}.engine) json["engine"] = options.engine;
  if (watched.interrupted) json["partial"] = true;
  return json;
}

// Goes from tick to tick and reports each. The error ends it.
Result<Watched> watch_ticks(const std::string& path, const Scene& scene, const CollideOptions& options,
                            collision::CollisionWatch& watch, std::ostream& out) {
  SceneMotion motion(scene);
  Progress progress(options.progress, options);
  Watched watched;
  for (;; ++watched.ticks) {
    const double time_s = options.at_s + static_cast<double>(watched.ticks) / options.hz;
    if (time_s > *options.until_s) break;
    watched.interrupted = options.interrupted && options.interrupted();
    if (watched.interrupted) break;
    progress.show(time_s);
    go_to(watch, motion, time_s);
    const collision::CollisionWatch::Tick& tick = watch.tick();
    if (!tick.refused.empty() || !tick.ended.empty() || !tick.began.empty() || !tick.not_colliding.empty()) {
      progress.hide();
    }
    if (!tick.refused.empty()) return std::unexpected(InputError{path + ": error: " + tick.refused.front().why, 1});
    report_tick(scene, time_s, watch, tick, options.json, watched.events, out);
  }
  progress.hide();
  return watched;
}

// A world's hierarchyFiles are those of our trees.
collision::HierarchyLoader loader_for(const std::string& path, const Engine& engine) {
  return engine.narrow_phase == nullptr ? config::mapped_hierarchies(path) : collision::HierarchyLoader{};
}

int watch_collisions(const std::string& path, const Scene& scene, const CollideOptions& options, const Engine& engine,
                     std::ostream& out, std::ostream& err) {
  std::ostream* const json = options.json ? &out : nullptr;
  if (const auto error = why_no_ticks(options)) return print_error(*error, err, json);
  const std::vector<std::string> warnings = warnings_about(scene);
  for (const std::string& warning : warnings) err << path << ": warning: " << warning << '\n';
  const auto start = std::chrono::steady_clock::now();
  collision::CollisionWatch watch(scene, loader_for(path, engine), {}, {engine.narrow_phase.get(), engine.broad_phase});
  watch.set_box_bound(box_bound(options));
  auto watched = watch_ticks(path, scene, options, watch, out);
  if (!watched) return print_error(watched.error(), err, json);
  for (const std::string& note : watch.notes()) err << path << ": note: " << note << '\n';
  if (watched->interrupted) {
    err << fmt::format("interrupted after {}: the results are partial, none is later than {} s\n",
                       counted(watched->ticks, "tick"),
                       options.at_s + (static_cast<double>(watched->ticks) - 1.0) / options.hz);
  }
  const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
  const collision::CollisionWatchCounters counters = watch.counters();
  if (options.json) {
    out << to_json(path, options, *watched, warnings, counters, micros.count())
               .dump(2, ' ', false, Json::error_handler_t::replace)
        << '\n';
  } else {
    out << (watched->interrupted ? "partial: " : "") << counted(watched->ticks, "tick")
        << "; pairs of objects: " << counters.pairs_far << " far, " << counters.pairs_unmoved << " unmoved, "
        << counters.pairs_separated << " separated, " << counters.pairs_queried
        << " asked; of Shapes: " << counters.shapes.pairs_witnessed << " touching where they did, "
        << counters.shapes.pairs_tested << " tested; " << micros.count() << " us\n";
  }
  return watched->interrupted ? kInterrupted : 0;
}

}  // namespace

int list_engines(bool json, std::ostream& out) {
  Json list = Json::array();
  for (const auto& [name, is_exact, reference, about] : collision::baselines::engines()) {
    list.push_back({{"name", name}, {"exact", is_exact}, {"reference", reference}, {"about", about}});
    if (!json) out << fmt::format("{:<12} {} ({}; {})\n", name, about, is_exact ? "exact" : "approximate", reference);
  }
  if (json) out << list.dump(2) << '\n';
  return 0;
}

int run_collide(const std::string& path, const CollideOptions& options, std::ostream& out, std::ostream& err) {
  std::ostream* const json_errors = options.json ? &out : nullptr;
  const auto file = open_world(path, options.reading, err, json_errors);
  if (!file) return file.error();
  const Scene& scene = *(*file)->result.scene;
  const auto engine = collision::baselines::make_engine(options.engine);
  if (!engine) return print_error({"error: --engine: " + engine.error()}, err, json_errors);
  if (!engine->description.is_exact) {
    err << path << ": warning: the engine " << engine->description.name << " is not exact: near is taken for a touch\n";
  }
  if (options.until_s) return watch_collisions(path, scene, options, *engine, out, err);
  const auto start = std::chrono::steady_clock::now();
  collision::SceneQuery query(scene, loader_for(path, *engine));
  query.set_narrow_phase(engine->narrow_phase.get());
  query.set_box_bound(box_bound(options));
  SceneMotion motion(scene);
  go_to(query, motion, options.at_s);
  std::vector<Answer> answers;
  for (const CollisionInterest& interest : scene.interests) {
    for (const ObjectId collidee : interest.collidees) {
      auto collision = query.collide(interest.collider, collidee, interest.type);
      if (!collision) return print_error({path + ": error: " + collision.error(), 1}, err, json_errors);
      answers.push_back({interest.collider, collidee, interest.type, std::move(*collision)});
    }
  }
  for (const std::string& note : query.notes()) err << path << ": note: " << note << '\n';
  const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
  const collision::SceneQueryCounters counters = query.counters();
  if (options.json) {
    Json interests = Json::array();
    for (const Answer& answer : answers) interests.push_back(to_json(scene, answer));
    Json json = {{"world", path},
                 {"time_s", options.at_s},
                 {"interests", std::move(interests)},
                 {"counters", to_json(counters)},
                 {"micros", micros.count()}};
    if (options.engine != CollideOptions{}.engine) json["engine"] = options.engine;
    out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    return 0;
  }
  for (const Answer& answer : answers) print_text(scene, answer, out);
  out << counted(answers.size(), "interest") << "; " << counted(counters.hierarchies_built, "hierarchy", "hierarchies")
      << " of " << counted(counters.nodes_built, "node") << "; tests: " << counters.queries.bv_tests
      << " of bounding volumes, " << counters.queries.triangle_tests << " of polygons, "
      << counters.queries.orientation.exact << " in exact arithmetic; " << micros.count() << " us\n";
  return 0;
}

}  // namespace peerd
