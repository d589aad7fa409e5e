#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/sparse_table.hpp"
#include "core/time.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// Decides which pairs of one MotionWorld are put off (MotionWorld::put_off()): those of remote objects that nobody sees
// here and that cannot reach what must be right, which are own objects and what else the caller keeps. What only scene
// objects are the ends of, and one of them answers, all peers compute alike: it is searched, and what moves a part of
// these ends is kept.
//
// What moves together is one unit: a carrier with all below it. A unit that is put off, and has a pair that has
// stopped, may have been hit since: it is in doubt, and is somewhere in the ball that grows about its last certain
// place with the highest speed that one hit leaves it. In doubt is, too, what such a ball touches and what answers
// contacts. A unit in doubt is taken up again before its ball touches what is kept, what is in sight, or what is taken
// up with it; so is what it may have met. Nothing else depends on it.
//
//   asleep ── its pair stops ──> in doubt ── an update of it ──> asleep
//     ^                             │ its ball comes into sight, or near what must be right
//     └── out of sight ── awake <───┘ searched from where it stopped
class UnseenPairs {
 public:
  enum class Standing : std::uint8_t {
    kScene,   // nobody owns it, and it goes its way by what is certain
    kFree,    // nobody owns it, and it answers what remote objects do in this world
    kRemote,  // its owner is another peer
    kKept     // its contacts and states must be right at any time
  };
  // Answers to questions about the peer.
  struct Peer {
    std::function<Standing(ObjectId)> standing;
    // Whether a peer decides contacts of the two and publishes what it has decided.
    std::function<bool(ObjectId, ObjectId)> is_decided;
    // Whether a ball [m, world frame] may be in sight; null: nothing of this world is shown.
    std::function<bool(const Vec3& center, double radius_m)> in_sight;
    // What is kept depends on what it may meet within so long [s].
    double ahead_s = 0.0;
  };

  // The model outlives this object. For another one of the same scene another object is made, of which nothing is put
  // off.
  explicit UnseenPairs(const WorldModel& model);

  // The world has begun anew, or goes on by another model, at t: nothing of it is put off.
  void restart(SimTime t);
  // Puts pairs off, and takes pairs up, for a world that is about to be advanced to `to`, or has just been; `awake` is
  // taken up in any case. True where one that had stopped is searched again: its contacts since wait for an advance().
  bool update(MotionWorld& world, SimTime to, const Peer& peer, std::optional<ObjectId> awake = {});
  // Takes all pairs up. True where one that had stopped is searched again.
  bool take_up_all(MotionWorld& world);
  // Whether the object may have met something that the world has not found.
  [[nodiscard]] bool is_in_doubt(ObjectId object) const;
  // Whether something else than the object's own way depends on what it has met since it is in doubt: then it is taken
  // up before its motion is replaced.
  [[nodiscard]] bool others_depend_on(const MotionWorld& world, ObjectId object) const;

  // The part pairs that are put off.
  [[nodiscard]] std::size_t pairs_put_off() const { return put_off_count_; }
  // Calls `function` for the objects that were in doubt and have been taken up since the last call.
  template <class Function>
  void take_woken(Function function) {
    for (const ObjectId object : woken_) function(object);
    woken_.clear();
  }

 private:
  static constexpr std::uint32_t kNone = ModelNode::kNone;

  struct Ball {
    Vec3 center = Vec3::Zero();
    double radius_m = 0.0;
  };
  struct Doubt {
    SimTime since;
    double hit_by_m_s = 0.0;  // the speed of the fastest that may have hit it; what stands makes nothing faster
  };
  // A node of a unit, by what this object was told last.
  struct UnitNode {
    std::uint32_t index;  // in the model
    Standing standing = Standing::kScene;
    std::uint64_t revision = 0;
  };
  struct Unit {
    std::vector<UnitNode> nodes;           // ascending
    std::vector<std::uint32_t> answering;  // those of them that answer contacts
    std::vector<std::uint32_t> pairs;      // part pairs that its motion changes
    bool is_scripted = false;              // the file moves some of it
    bool flexes = false;                   // the shape of something that goes with it changes
    Standing standing = Standing::kScene;
    bool awake = true;
    std::optional<Doubt> doubt;
    std::optional<std::pair<Standing, bool>> applied;  // standing and awake, as its pairs have it
    SimTime certain_until{};                           // where it is not in doubt: until then its way has been compared
    double speed_m_s = 0.0, acceleration_m_s2 = 0.0;   // at most, before `to`
    Ball ball;                                         // where it is until `to`
  };
  struct PartPairState {
    std::vector<std::uint32_t> units;  // that its parts and ends are of
    bool can_wait = true;
    bool put_off = false;
  };

  [[nodiscard]] static bool moves(const Unit& unit) {
    return unit.standing != Standing::kScene || unit.is_scripted || !unit.answering.empty();
  }
  [[nodiscard]] static bool is_predicted(const Unit& unit) {
    return unit.standing == Standing::kFree || unit.standing == Standing::kRemote;
  }
  // How fast a part of the unit may go [m/s].
  [[nodiscard]] static double reach_m_s(const Unit& unit);
  [[nodiscard]] bool answers(std::uint32_t pair, bool collider) const;
  [[nodiscard]] std::uint32_t node_of_end(std::uint32_t pair, bool collider) const;
  [[nodiscard]] std::uint32_t unit_of_end(std::uint32_t pair, bool collider) const {  // of a pair that is here
    return unit_of_node_[node_of_end(pair, collider)];
  }
  [[nodiscard]] std::uint32_t unit_of(ObjectId object) const;  // kNone: none of its pairs is known
  [[nodiscard]] Standing standing_of(std::uint32_t node) const;
  // Takes in the pairs that the world has, and did not have before, and what moves them.
  void take_in(MotionWorld& world);
  void take_in_pair(std::uint32_t pair);
  [[nodiscard]] std::uint32_t unit_with(std::uint32_t node);
  [[nodiscard]] static bool touch(const Ball& a, const Ball& b, double margin_m);
  void find_standing(const Peer& peer);
  [[nodiscard]] bool carries_an_end_of_the_scene(const Unit& unit) const;
  void measure(const MotionWorld& world, SimTime to, const Peer& peer);
  void grow_ball(const MotionWorld& world, Unit& unit, SimTime to) const;
  // What has got another way since the last update has gone that way since this instant.
  [[nodiscard]] SimTime certain_until(const MotionWorld& world, Unit& unit) const;
  void note_doubt(std::uint32_t unit, SimTime since, double hit_by_m_s, const MotionWorld& world, SimTime to);
  void note_stops(MotionWorld& world, SimTime to, const Peer& peer);
  [[nodiscard]] double friction_of(const MotionWorld& world, ObjectId object, SimTime t) const;
  void wake_what_is_near_kept(SimTime to);
  void follow_doubts(const MotionWorld& world, SimTime to, double ahead_s);
  [[nodiscard]] bool can_wait(const PartPairState& pair) const;
  bool apply(MotionWorld& world);

  const WorldModel* model_;
  std::vector<std::uint32_t> unit_of_node_;  // kNone: none of its pairs is known
  std::vector<Unit> units_;
  SparseTable<PartPairState> pairs_;  // MotionWorld::known_pairs()
  std::vector<bool> was_awake_;
  std::size_t put_off_count_ = 0;
  SimTime last_{}, before_{};  // until which the world has been advanced, and had been before that
  double fastest_m_s_ = 0.0;   // of all that moves
  std::vector<ObjectId> woken_;
};

}  // namespace peerd::replication
