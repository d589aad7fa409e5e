#include "peerd/commands/collide_command.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <ostream>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "collision/scene/collision_watch.hpp"
#include "collision/scene/scene_query.hpp"
#include "core/motion/scene_motion.hpp"
#include "peerd/commands/problems.hpp"
#include "peerd/input/hierarchy_files.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

collision::BoxBound box_bound(const CollideOptions& options) {
  return options.realigned_boxes ? collision::BoxBound::kRealigned : collision::BoxBound::kVertices;
}

const char* name_of(CollisionType type) {
  switch (type) {
    case CollisionType::kBox:
      return "box";
    case CollisionType::kWitness:
      return "witness";
    case CollisionType::kAllPairs:
      return "allpairs";
  }
  return "";
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
  if (answer.type == CollisionType::kAllPairs) out << ", " << pairs.size() << " pairs of polygons";
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

int watch_collisions(const std::string& path, const Scene& scene, const CollideOptions& options, std::ostream& out,
                     std::ostream& err) {
  const auto start = std::chrono::steady_clock::now();
  collision::CollisionWatch watch(scene, config::mapped_hierarchies(path));
  watch.set_box_bound(box_bound(options));
  SceneMotion motion(scene);
  Json events = Json::array();
  std::uint64_t ticks = 0;
  for (double before_s = -std::numeric_limits<double>::infinity();; ++ticks) {
    const double time_s = options.at_s + static_cast<double>(ticks) / options.hz;
    // Time stands still where a tick is less than a step of the binary64 numbers.
    if (!(time_s <= *options.until_s && time_s > before_s)) break;
    before_s = time_s;
    go_to(watch, motion, time_s);
    const collision::CollisionWatch::Tick& tick = watch.tick();
    if (!tick.refused.empty()) {
      err << path << ": error: " << tick.refused.front().why << '\n';
      return 1;
    }
    report_tick(scene, time_s, watch, tick, options.json, events, out);
  }
  for (const std::string& note : watch.notes()) err << path << ": note: " << note << '\n';
  const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
  const collision::CollisionWatchCounters counters = watch.counters();
  if (!options.json) {
    out << ticks << " ticks; pairs of objects: " << counters.pairs_far << " far, " << counters.pairs_unmoved
        << " unmoved, " << counters.pairs_separated << " separated, " << counters.pairs_queried
        << " asked; of Shapes: " << counters.shapes.pairs_witnessed << " touching where they did, "
        << counters.shapes.pairs_tested << " tested; " << micros.count() << " us\n";
    return 0;
  }
  Json counted = to_json(counters.query);
  counted.update({{"pairs_far", counters.pairs_far},
                  {"pairs_unmoved", counters.pairs_unmoved},
                  {"pairs_separated", counters.pairs_separated},
                  {"pairs_asked", counters.pairs_queried},
                  {"pairs_witnessed", counters.shapes.pairs_witnessed},
                  {"pairs_tested", counters.shapes.pairs_tested}});
  const Json json = {
      {"world", path},  {"time_s", options.at_s},      {"until_s", *options.until_s},    {"hz", options.hz},
      {"ticks", ticks}, {"events", std::move(events)}, {"counters", std::move(counted)}, {"micros", micros.count()}};
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  return 0;
}

}  // namespace

int run_collide(const std::string& path, const CollideOptions& options, std::ostream& out, std::ostream& err) {
  const auto file = open_world(path, options.reading, err);
  if (!file) return file.error();
  const Scene& scene = *(*file)->result.scene;
  if (options.until_s) return watch_collisions(path, scene, options, out, err);
  const auto start = std::chrono::steady_clock::now();
  collision::SceneQuery query(scene, config::mapped_hierarchies(path));
  query.set_box_bound(box_bound(options));
  SceneMotion motion(scene);
  go_to(query, motion, options.at_s);
  std::vector<Answer> answers;
  for (const CollisionInterest& interest : scene.interests) {
    for (const ObjectId collidee : interest.collidees) {
      auto collision = query.collide(interest.collider, collidee, interest.type);
      if (!collision) {
        err << path << ": error: " << collision.error() << '\n';
        return 1;
      }
      answers.push_back({interest.collider, collidee, interest.type, std::move(*collision)});
    }
  }
  for (const std::string& note : query.notes()) err << path << ": note: " << note << '\n';
  const std::chrono::duration<double, std::micro> micros = std::chrono::steady_clock::now() - start;
  const collision::SceneQueryCounters counters = query.counters();
  if (options.json) {
    Json interests = Json::array();
    for (const Answer& answer : answers) interests.push_back(to_json(scene, answer));
    const Json json = {{"world", path},
                       {"time_s", options.at_s},
                       {"interests", std::move(interests)},
                       {"counters", to_json(counters)},
                       {"micros", micros.count()}};
    out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    return 0;
  }
  for (const Answer& answer : answers) print_text(scene, answer, out);
  out << answers.size() << " interests; " << counters.hierarchies_built << " hierarchies of " << counters.nodes_built
      << " nodes; tests: " << counters.queries.bv_tests << " of bounding volumes, " << counters.queries.triangle_tests
      << " of polygons, " << counters.queries.orientation.exact << " in exact arithmetic; " << micros.count()
      << " us\n";
  return 0;
}

}  // namespace peerd
