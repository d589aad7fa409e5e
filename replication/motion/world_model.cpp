#include "replication/motion/world_model.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>

#include "collision/contact/contact_time.hpp"
#include "core/motion/predefined_motion.hpp"

namespace peerd::replication {
namespace {

bool is_inside(const Scene& scene, ObjectId inner, ObjectId outer) {
  return inner.value >= outer.value && inner.value < scene.at(outer).subtree_end;
}

// The index of each pair in the model, by its type, its lower and its higher object.
using KnownPairs = std::map<std::tuple<CollisionType, ObjectId, ObjectId>, std::size_t>;

void add_pair(WorldModel& model, KnownPairs& known, const CollisionPair& pair) {
  assert(pair.collider != pair.collidee);
  const auto [lower, higher] = std::minmax(pair.collider, pair.collidee);
  const auto [it, is_new] = known.try_emplace({pair.type, lower, higher}, model.pairs.size());
  if (is_new) {
    model.pairs.push_back(pair);
  } else if (model.pairs[it->second].collider != pair.collider) {
    model.pairs[it->second].mutual = true;
  }
}

void index_pairs(WorldModel& model) {
  model.pairs_of_body.resize(model.bodies.size());
  model.partners_of_body.resize(model.bodies.size());
  const auto number = [&](ObjectId id) { return static_cast<std::uint32_t>(model.body(id) - model.bodies.data()); };
  for (std::uint32_t i = 0; i < model.pairs.size(); ++i) {
    const std::uint32_t a = number(model.pairs[i].collider), b = number(model.pairs[i].collidee);
    for (const auto& [of, partner] : {std::pair{a, b}, std::pair{b, a}}) {
      model.pairs_of_body[of].push_back(i);
      model.partners_of_body[of].push_back(partner);
    }
  }
  for (std::vector<std::uint32_t>& partners : model.partners_of_body) {
    std::ranges::sort(partners);
    partners.erase(std::ranges::unique(partners).begin(), partners.end());
  }
}

}  // namespace

const collision::Body* WorldModel::body(ObjectId id) const {
  const auto at = std::ranges::lower_bound(bodies, id, {}, &collision::Body::object);
  return at != bodies.end() && at->object == id ? &*at : nullptr;
}

std::span<const std::uint32_t> WorldModel::pairs_of(ObjectId id) const {
  const collision::Body* const of = body(id);
  if (of == nullptr) return {};
  return pairs_of_body[static_cast<std::size_t>(of - bodies.data())];
}

const CollisionResponse* WorldModel::response_of(ObjectId id) const {
  const auto& response = scene->object(id).response;
  return response ? &*response : nullptr;
}

std::unique_ptr<const WorldModel> make_world_model(const Scene& scene) {
  auto model = std::make_unique<WorldModel>();
  model->scene = &scene;
  std::vector<ObjectId> named;
  KnownPairs known;
  for (const CollisionInterest& interest : scene.interests) {
    for (ObjectId collidee : interest.collidees) {
      if (is_inside(scene, interest.collider, collidee) || is_inside(scene, collidee, interest.collider)) {
        model->unsupported.push_back(scene.path_of(interest.collider) + " against " + scene.path_of(collidee) +
                                     ": one contains the other; collisions within an object are not answered yet");
        continue;
      }
      add_pair(*model, known, {interest.collider, collidee, interest.type, false});
      named.push_back(interest.collider);
      named.push_back(collidee);
    }
  }
  std::ranges::sort(named);
  named.erase(std::ranges::unique(named).begin(), named.end());
  if (named.empty()) return model;
  const PredefinedMotion predefined(scene);
  for (ObjectId id : named) {
    model->bodies.push_back(collision::make_body(scene, id));
    if (predefined.moves(id)) model->moving.push_back(id);
    if (!predefined.stays_rigid(id)) {
      model->bodies.back().unsupported = scene.path_of(id) + ": the file changes its shape as it moves";
    }
    if (!model->bodies.back().unsupported.empty()) model->unsupported.push_back(model->bodies.back().unsupported);
  }
  assert(std::ranges::is_sorted(model->bodies, {}, &collision::Body::object));
  index_pairs(*model);
  for (const CollisionPair& pair : model->pairs) {
    const collision::Body &a = *model->body(pair.collider), &b = *model->body(pair.collidee);
    const bool already_reported = !a.unsupported.empty() || !b.unsupported.empty();
    if (pair.type == CollisionType::kBox || already_reported || collision::has_exact_answer(a, b)) continue;
    model->unsupported.push_back(scene.path_of(pair.collider) + " against " + scene.path_of(pair.collidee) +
                                 ": one is not convex, and one is larger than 2^58 m");
  }
  return model;
}

}  // namespace peerd::replication
