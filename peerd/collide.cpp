#include "peerd/collide.hpp"

#include <algorithm>
#include <chrono>
#include <ostream>
#include <vector>

#include <nlohmann/json.hpp>

#include "collision/scene_query.hpp"
#include "core/predefined_motion.hpp"
#include "peerd/config/hierarchy_files.hpp"
#include "peerd/problems.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

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

// What the file says, what its own movement makes of it by then, and, where nothing else moves an object, its
// velocityVector since time 0 (seed, equation C.1).
void go_to(collision::SceneQuery& query, const Scene& scene, double t_s) {
  std::vector<TransformFields> transforms = scene.transforms;
  PredefinedMotion motion(scene);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (scene.instances[i].transform == Instance::kNone) continue;
    TransformFields& fields = transforms[scene.instances[i].transform];
    fields.translation = scene.transform({i}).translation + scene.object({i}).velocity * t_s;
  }
  for (const ObjectId id : motion.driven_transforms()) {
    transforms[scene.at(id).transform] = motion.transform(id, t_s);
  }
  query.place(transforms);
  for (const std::uint32_t geometry : motion.flexible_geometries())
    query.reshape(geometry, motion.geometry(geometry, t_s));
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
  constexpr std::size_t kShown = 20;  // of an interest's pairs
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

}  // namespace

int run_collide(const std::string& path, const CollideOptions& options, std::ostream& out, std::ostream& err) {
  const auto file = open_world(path, err);
  if (!file) return file.error();
  const Scene& scene = *(*file)->result.scene;
  const auto start = std::chrono::steady_clock::now();
  collision::SceneQuery query(scene, config::mapped_hierarchies(path));
  go_to(query, scene, options.at_s);
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
