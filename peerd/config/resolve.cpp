#include "peerd/config/resolve.hpp"

#include <algorithm>
#include <set>

namespace peerd::config {
namespace {

// Finds the owner of each object, then its motion. The first motion that claims an object counts, and peers' own
// motions come before the scenario's.
class Resolver {
 public:
  Resolver(const RunSettings& run, const Scene& scene) : run_(run), scene_(scene), peers_(run.peers.size()) {}

  Result<std::vector<PeerObjects>> all() {
    for (std::size_t p = 0; p < peers_.size(); ++p) assign_owner(p);
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
             key + ": peer " + run_.peers[at->second].name + " owns \"" + scene_.path_of(object) + "\" too");
      }
    }
  }

  // `only` is the peer whose own motion this is; it moves nothing that another peer owns.
  void move(const MotionSettings& motion, const std::string& pattern, const std::string& key,
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
        fail(motion.at, key + ": \"" + scene_.path_of(objects[n]) + "\" is moved by " + other->second + " too");
      if (here && !moved_.contains(objects[n])) numbers.push_back(n);
    }
    if (only && !owns_any) {
      fail(motion.at, key + ": the peer moves only what it owns; add \"" + pattern + "\" to peer." +
                          run_.peers[*only].name + ".owns");
    }
    if (error_ || numbers.empty()) return;
    for (const std::size_t n : numbers) moved_.insert(objects[n]);
    if (std::holds_alternative<ExternalProgram>(motion.kind)) {
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
    auto sources = make_sources(motion, motion.at + "error: " + key, places, numbers, run_.seed, run_.duration_s);
    if (!sources) {
      error_ = sources.error();
      return;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const ObjectId object = objects[numbers[i]];
      peers_[runs_.at(object)].motions.emplace(object, std::move((*sources)[i]));
    }
  }

  void find_objects_of(std::size_t p) {
    const auto& viewpoint = run_.peers[p].viewpoint;
    if (error_ || !viewpoint || viewpoint->object.empty()) return;
    const auto object = find_object(scene_, viewpoint->object, "peer." + run_.peers[p].name + ".viewpoint");
    if (object) {
      peers_[p].viewpoint = *object;
    } else {
      error_ = object.error();
    }
  }

  const RunSettings& run_;
  const Scene& scene_;
  std::vector<PeerObjects> peers_;
  std::map<ObjectId, std::size_t> runs_;  // index of the owner
  std::set<ObjectId> moved_;              // objects that have a motion
  std::optional<InputError> error_;
};

}  // namespace

Result<std::vector<PeerObjects>> resolve(const RunSettings& run, const Scene& scene) {
  return Resolver(run, scene).all();
}

}  // namespace peerd::config
