#include "peerd/peer/config/resolve.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <set>

#include "core/motion/carriers.hpp"
#include "core/motion/founder_objects.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/motion/viewpoint_nodes.hpp"
#include "peerd/peer/config/events.hpp"
#include "peerd/peer/config/shown_path.hpp"

namespace peerd::config {
namespace {

// The index of the peer that founds the session, as far as the configuration knows.
std::size_t founder_in(const RunSettings& run) {
  assert(!run.peers.empty());
  std::size_t founder = 0;
  const auto rank = [&](std::size_t p) {
    return std::pair(!starts_with(run.events, run.peers[p].name), run.peers[p].id);
  };
  for (std::size_t p = 1; p < run.peers.size(); ++p) {
    if (rank(p) < rank(founder)) founder = p;
  }
  return founder;
}

// Finds the owner of each object, then its motion. The first motion that claims an object counts, and peers' own
// motions come before the scenario's.
class Resolver {
 public:
  Resolver(const RunSettings& run, const Scene& scene) : run_(run), scene_(scene), peers_(run.peers.size()) {}

  Result<std::vector<PeerObjects>> all() {
    for (std::size_t p = 0; p < peers_.size(); ++p) assign_owner(p);
    assign_to_founder();
    for (std::size_t p = 0; p < peers_.size(); ++p) {
      const PeerSettings& peer = run_.peers[p];
      std::map<ObjectId, std::string> claimed;
      for (const auto& [pattern, motion] : peer.motion) {
        move(motion, pattern, "peer." + peer.name + ".motion." + pattern, claimed, p);
      }
    }
    std::map<ObjectId, std::string> claimed;
    for (const auto& [pattern, motion] : run_.motion) move(motion, pattern, "motion." + pattern, claimed, std::nullopt);
    for (std::size_t p = 0; p < peers_.size(); ++p) {
      find_objects_of(p);
      if (run_.peers[p].feed.udp.empty() || !peers_[p].outside.empty()) continue;
      fail("", "peer." + run_.peers[p].name +
                   ".feed.udp: no program moves anything here; write outside = true in a motion");
    }
    if (error_) return std::unexpected(*error_);
    return std::move(peers_);
  }

 private:
  // Only the first error is kept.
  std::vector<ObjectId> find(const NodePattern& pattern, const std::string& key) {
    if (error_) return {};
    auto found = find_objects(scene_, pattern, key);
    if (found) return *std::move(found);
    error_ = found.error();
    return {};
  }
  void fail(const std::string& at, const std::string& sentence) {
    if (!error_) error_ = InputError{at + "error: " + sentence};
  }

  void assign_owner(std::size_t p) {
    const std::string key = "peer." + run_.peers[p].name + ".owns";
    for (const NodePattern& pattern : run_.peers[p].owns) {
      for (const ObjectId object : find(pattern, key)) {
        const auto [at, added] = runs_.try_emplace(object, p);
        if (added) peers_[p].owned.push_back(object);
        if (at->second == p) continue;
        fail(pattern.at,
             key + ": peer " + run_.peers[at->second].name + " owns " + shown(scene_.path_of(object)) + " too");
      }
    }
  }

  void assign_to_founder() {
    const std::size_t founder = founder_in(run_);
    std::vector<ObjectId>& owned = peers_.size() > 1 ? peers_[founder].owned : peers_[founder].owned_by_founder;
    for (const ObjectId object : founder_objects(scene_)) {
      if (runs_.try_emplace(object, founder).second) owned.push_back(object);
    }
  }

  // `only` is the peer whose own motion this is; it moves nothing that another peer owns.
  void move(const motion::MotionSettings& motion, const std::string& pattern, const std::string& key,
            std::map<ObjectId, std::string>& claimed, std::optional<std::size_t> only) {
    const NodePattern asked(pattern, motion.at);
    const std::vector<ObjectId> objects = find(asked, key);
    std::vector<std::size_t> numbers;
    bool owns_any = false;
    for (std::size_t n = 0; n < objects.size(); ++n) {
      const auto runner = runs_.find(objects[n]);
      const bool here = runner != runs_.end() && (!only || runner->second == *only);
      owns_any = owns_any || here;
      if (only && !here) continue;
      const auto [other, added] = claimed.try_emplace(objects[n], key);
      if (!added)
        fail(motion.at, key + ": " + shown(scene_.path_of(objects[n])) + " is moved by " + other->second + " too");
      if (here && !moved_.contains(objects[n])) numbers.push_back(n);
    }
    if (only && !owns_any) {
      fail(motion.at, key + ": the peer moves only what it owns; add " + shown(pattern) + " to peer." +
                          run_.peers[*only].name + ".owns");
    }
    if (error_) return;
    if (numbers.empty()) return check_unused(motion, key, objects);
    for (const std::size_t n : numbers) moved_.insert(objects[n]);
    if (std::holds_alternative<motion::ExternalProgram>(motion.kind)) {
      for (const std::size_t n : numbers) {
        const std::string name = asked.is_path() ? pattern : scene_.path_of(objects[n]);
        peers_[runs_.at(objects[n])].outside.emplace(name, objects[n]);
      }
      return;
    }
    if (const auto* launch = std::get_if<replication::Launch>(&motion.kind)) {
      for (const std::size_t n : numbers) peers_[runs_.at(objects[n])].launches.emplace(objects[n], *launch);
      return;
    }
    std::vector<Pose> places;
    for (const ObjectId object : objects) places.push_back(scene_.rigid_pose(object));
    auto sources =
        motion::make_sources(motion, motion.at + "error: " + key, places, numbers, run_.seed, run_.duration_s);
    if (!sources) {
      error_ = sources.error();
      return;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const ObjectId object = objects[numbers[i]];
      peers_[runs_.at(object)].motions.emplace(object, std::move((*sources)[i]));
    }
  }

  // A motion that moves nothing may have mistakes in it nevertheless.
  void check_unused(const motion::MotionSettings& motion, const std::string& key,
                    const std::vector<ObjectId>& objects) {
    const bool text_from_outside = std::holds_alternative<motion::MotionFormula>(motion.kind) ||
                                   std::holds_alternative<motion::Track>(motion.kind);
    if (!text_from_outside) return;
    const std::array places{scene_.rigid_pose(objects.front())};
    const std::array<std::size_t, 1> first{0};
    const auto sources =
        motion::make_sources(motion, motion.at + "error: " + key, places, first, run_.seed, run_.duration_s);
    if (!sources) error_ = sources.error();
  }

  std::optional<ObjectId> object_of(const ViewpointSettings& viewpoint, const std::string& key) {
    if (error_ || viewpoint.object.empty()) return std::nullopt;
    const auto object = find_object(scene_, viewpoint.object, key);
    if (object) return *object;
    error_ = object.error();
    return std::nullopt;
  }

  void find_objects_of(std::size_t p) {
    const PeerSettings& peer = run_.peers[p];
    if (peer.viewpoint) peers_[p].viewpoint = object_of(*peer.viewpoint, "peer." + peer.name + ".viewpoint");
    for (const ViewpointSettings& view : peer.views) {
      peers_[p].views.push_back(object_of(view, "peer." + peer.name + ".view"));
    }
    const bool sees = peer.viewpoint || !peer.views.empty() || bound_viewpoint(scene_);
    if (!error_ && peer.skip_unseen && !sees) {
      error_ = InputError{
          "error: peer." + peer.name + ".skip_unseen: the peer has no viewpoint, and the world has no Viewpoint node",
          2};
    }
  }

  const RunSettings& run_;
  const Scene& scene_;
  std::vector<PeerObjects> peers_;
  std::map<ObjectId, std::size_t> runs_;  // index of the owner
  std::set<ObjectId> moved_;              // objects that have a motion
  std::optional<InputError> error_;
};

// The objects of a pattern; none where it names none, which resolve() reports.
std::vector<ObjectId> objects_or_none(const Scene& scene, const NodePattern& pattern) {
  return find_objects(scene, pattern, "").value_or(std::vector<ObjectId>{});
}

// The key of the peer's own motion that moves each object; empty for what a peer owns and no motion of its own moves.
std::map<ObjectId, std::string> own_motions(const RunSettings& run, const Scene& scene) {
  std::map<ObjectId, std::string> owned;
  std::vector<std::set<ObjectId>> of_peer(run.peers.size());
  for (std::size_t p = 0; p < of_peer.size(); ++p) {
    for (const NodePattern& pattern : run.peers[p].owns) {
      for (const ObjectId object : objects_or_none(scene, pattern)) of_peer[p].insert(object);
    }
    for (const ObjectId object : of_peer[p]) owned.emplace(object, "");
  }
  for (const ObjectId object : founder_objects(scene)) {
    if (owned.emplace(object, "").second) of_peer[founder_in(run)].insert(object);
  }
  for (std::size_t p = 0; p < of_peer.size(); ++p) {
    for (const auto& [pattern, motion] : run.peers[p].motion) {
      for (const ObjectId object : objects_or_none(scene, NodePattern(pattern, motion.at))) {
        if (of_peer[p].contains(object)) owned.at(object) = "peer." + run.peers[p].name + ".motion." + pattern;
      }
    }
  }
  return owned;
}

// A warning for the nodes of a peer's `owns` that its owner cannot move, and for those that only a ROUTE would move.
void warn_of_idle_owned(const RunSettings& run, const Scene& scene, std::vector<std::string>& warnings) {
  const PredefinedMotion predefined(scene);
  const Carriers carriers(scene, predefined, {});
  std::set<ObjectId> moved;
  const auto add_moved = [&](const std::map<std::string, motion::MotionSettings>& motions) {
    for (const auto& [pattern, motion] : motions) {
      const auto objects = objects_or_none(scene, NodePattern(pattern, motion.at));
      moved.insert(objects.begin(), objects.end());
    }
  };
  add_moved(run.motion);
  for (const PeerSettings& peer : run.peers) add_moved(peer.motion);
  for (const KeySensor& sensor : scene.key_sensors) {
    if (sensor.recipient) moved.insert(*sensor.recipient);
  }
  for (const PeerSettings& peer : run.peers) {
    for (const NodePattern& pattern : peer.owns) {
      for (const ObjectId object : objects_or_none(scene, pattern)) {
        const std::string who =
            pattern.at + "warning: peer." + peer.name + ".owns: " + shown(scene.path_of(object)) + ' ';
        if (carriers.distorted(object)) {
          warnings.push_back(who +
                             "stays where the world has it: no owner moves what a driven scale changes, or what "
                             "turns below an uneven scale");
        } else if (!predefined.fields_of(object).empty() && !moved.contains(object)) {
          warnings.push_back(who +
                             "stands still: a ROUTE moves it while nobody owns it, and no motion of its owner does");
        }
      }
    }
  }
}

}  // namespace

std::vector<ObjectId> owned_in(std::span<const RunSettings> runs, const Scene& scene) {
  std::set<std::string> patterns;
  for (const RunSettings& run : runs) {
    for (const PeerSettings& peer : run.peers) {
      for (const NodePattern& pattern : peer.owns) patterns.insert(pattern.text);
    }
  }
  std::set<ObjectId> owned;
  for (const std::string& pattern : patterns) {
    if (const auto found = find_objects(scene, pattern, "")) owned.insert(found->begin(), found->end());
  }
  return {owned.begin(), owned.end()};
}

std::vector<std::string> settings_without_effect(const RunSettings& run, const Scene& scene) {
  const std::map<ObjectId, std::string> owned = own_motions(run, scene);
  std::vector<std::string> names;
  for (const auto& [object, motion] : owned) names.push_back(scene.path_of(object));
  std::vector<std::string> warnings;
  for (const auto& [pattern, motion] : run.motion) {
    const std::vector<ObjectId> objects = objects_or_none(scene, NodePattern(pattern, motion.at));
    std::string moved_by;
    const bool effective = std::ranges::any_of(objects, [&](ObjectId object) {
      const auto at = owned.find(object);
      if (at != owned.end() && !at->second.empty()) moved_by = at->second;
      return at != owned.end() && at->second.empty();
    });
    if (effective || objects.empty()) continue;
    std::string why = "no peer owns what it names";
    if (const auto meant = did_you_mean(pattern, names)) why += "; did you mean motion." + *meant + "?";
    if (!moved_by.empty()) why = moved_by + " comes first";
    warnings.push_back(motion.at + "warning: motion." + pattern + " has no effect: " + why);
  }
  warn_of_idle_owned(run, scene, warnings);
  return warnings;
}

Result<std::vector<PeerObjects>> resolve(const RunSettings& run, const Scene& scene) {
  return Resolver(run, scene).all();
}

}  // namespace peerd::config
