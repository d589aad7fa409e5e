#pragma once
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <boost/container/small_vector.hpp>

#include "core/object_table.hpp"
#include "core/sparse_table.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/swept_bound.hpp"
#include "replication/physics/laws/timeline.hpp"
#include "replication/physics/world/part_query.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// The role of an object in a MotionWorld: what it does in a contact. Roles from kAuthoritative on respond.
enum class Role : std::uint8_t {
  kScene,          // owned by nobody; a script may move it, and it does not respond
  kDriven,         // moved by samples from outside; its contacts are reported, and it does not respond
  kAuthoritative,  // responds to contacts; responses to what others own are final (an object of this peer)
  kPredicted,      // responds to contacts; a response is retracted when its cause turns out to have moved otherwise
};

// A decision on a contact after which the object rests against another one gives its law with this. Each peer then
// solves the resting contact by itself.
struct Rest {
  ObjectId partner;
  Vec3 normal;              // unit, world frame, facing the object
  Vec3 free, partner_free;  // the accelerations of the two where nothing bears them [m/s^2, world frame]
};

// A law that was set from outside, and is in force from `at` on; in the frame of the object's carrier.
struct Base {
  SimTime at;
  std::optional<MotionModel> model;  // none: the object goes on as it moves then, and only `free` is new
  std::optional<Rest> rest{};
  // Others bear or push the object, which has this acceleration where nothing does [m/s^2, world frame].
  std::optional<Vec3> free{};
};

// Timelines keep this much of the past, for updates and decisions that arrive late.
inline constexpr Duration kWorldHistory = std::chrono::seconds(6);

// The most that is kept of one object's bases or updates: beyond what 600 ticks a second say in kWorldHistory.
inline constexpr std::size_t kKeptMax = 4096;

// Makes room in what is kept, ascending by its `at`, for what comes at t: what is of that time or later is void, and
// what is older than kWorldHistory before `now` is forgotten, some of it a second later.
template <class Kept>
void forget_kept(std::vector<Kept>& kept, SimTime t, SimTime now) {
  while (!kept.empty() && kept.back().at >= t) kept.pop_back();
  const SimTime oldest = now - kWorldHistory;
  if (!kept.empty() && kept.front().at < oldest - std::chrono::seconds(1)) {
    kept.erase(kept.begin(), std::ranges::lower_bound(kept, oldest, {}, &Kept::at));
  }
  if (kept.size() >= kKeptMax) kept.erase(kept.begin(), kept.begin() + kKeptMax / 2);
}

struct MovingObject {
  ObjectId id;
  Role role;
  Timeline timeline;
  SimTime base_time;
  SimTime given_time;  // of the last base by set_base(); restate() leaves it
  std::uint64_t revision = 0;
  bool answers = false;                      // contacts of some pair
  bool pruning_scheduled = false;            // the object waits to be pruned
  bool changed = false;                      // since the last take_changed()
  bool borne = false;                        // its law's acceleration is what those that bear it leave of `free`
  bool borne_unseen = false;                 // its owner says that others bear it, and here nothing touches it
  bool free_is_given = false;                // by set_free_acceleration()
  Vec3 free = Vec3::Zero();                  // its acceleration where nothing bears it [m/s^2]; void if it is neither
  std::uint32_t carrier = ModelNode::kNone;  // index; its timeline is relative to that object's
  SweptBound bound;  // of its body: the last one; it answers for nothing once the timeline changes
  // In a world that replays them (MotionWorld::replay_bases()): those of the last kHistory, ascending. There base_time
  // stays at the beginning.
  std::vector<Base> bases{};

  // Whether physics moves the object, and it answers contacts of some pair.
  [[nodiscard]] bool is_answering() const { return role >= Role::kAuthoritative && answers; }
  // Whether the object responds to a contact at t. An update that its owner made after t already contains the outcome.
  [[nodiscard]] bool will_respond(bool registered, SimTime t) const {
    return registered && role >= Role::kAuthoritative && base_time <= t;
  }
};

// How a world goes on when the scene has been edited.
struct SceneChange {
  SimTime at{};  // the instant at which the edit takes effect
  // Whether something moves the object, so that it stays where it is whatever the scene says of its place.
  std::function<bool(ObjectId)> is_moved;
  std::function<Role(ObjectId)> role_of;  // of what is new
};

// The objects of a MotionWorld with their timelines, by index: the model's nodes, then the other declared objects in
// order of declaration. Laws are relative to the carrier of an object; states in the world are composed. A node costs
// nothing but a few bytes until somebody asks for it: it stands at its place in the file.
class MovingObjects {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr Duration kHistory = kWorldHistory;
  // The time that a bound of a moving body is for reaches no farther than to the next multiple of this. A longer one
  // finds contacts that the next update makes void; a shorter one searches more often.
  static constexpr Duration kLookahead = std::chrono::milliseconds(250);

  MovingObjects(const WorldModel& model, SimTime start);

  [[nodiscard]] std::size_t size() const { return objects_.size(); }
  [[nodiscard]] MovingObject& operator[](std::size_t index) {
    MovingObject* const known = objects_.find(index);
    return known != nullptr ? *known : make(index);
  }
  [[nodiscard]] const MovingObject& operator[](std::size_t index) const {
    const MovingObject* const known = objects_.find(index);
    return known != nullptr ? *known : make(index);
  }
  // Those that somebody has asked for, ascending.
  [[nodiscard]] std::vector<std::uint32_t> asked_for() const;
  // Whether the node has stood at its place in the file all the time.
  [[nodiscard]] bool has_never_moved(std::size_t node) const;
  // Returns the position of a node that has never moved [m, frame of its carrier].
  [[nodiscard]] Vec3 first_position(std::size_t node) const;
  // Null where nobody has asked for it.
  [[nodiscard]] const MovingObject* peek(std::size_t index) const { return objects_.find(index); }
  [[nodiscard]] bool contains(ObjectId id) const { return index_or_none(id) != kNone; }
  [[nodiscard]] ObjectId id_of(std::size_t index) const {
    return index < model_->nodes.size() ? model_->nodes[index].object : objects_[index].id;
  }
  void set_role(std::size_t index, Role role);
  [[nodiscard]] std::size_t index_of(ObjectId id) const {
    const std::uint32_t index = index_or_none(id);
    assert(index != kNone);
    return index;
  }
  void add(ObjectId object);  // one that the model does not need
  // Goes on by another model of the same scene, in which more nodes are carriers. Indices change.
  void change_model(const WorldModel& next, SimTime now);
  // Goes on by the model of another scene, which edits have made of the one before. Indices change. Returns the laws,
  // in the frames of their carriers, that objects have to be given at that instant because of it.
  struct Placed {
    ObjectId object;
    MotionModel law;
  };
  [[nodiscard]] std::vector<Placed> change_scene(const WorldModel& next, const SceneChange& change);

  void set_flexible(FlexibleParts& flexible) { flexible_ = &flexible; }
  [[nodiscard]] FlexibleParts* flexible() const { return flexible_; }
  [[nodiscard]] const collision::Body& body(std::size_t object) const { return model_->bodies[object]; }
  // The objects that go with this one.
  [[nodiscard]] std::span<const std::uint32_t> carried_by(std::size_t object) const;

  // The timelines from below `common` down to the object's own.
  using OwnChain = boost::container::small_vector<const Timeline*, 4>;
  [[nodiscard]] OwnChain chain_of(std::uint32_t object, std::uint32_t common = kNone) const;
  [[nodiscard]] KinematicState world_at(std::size_t object, SimTime t) const;
  [[nodiscard]] KinematicState carrier_at(std::size_t object, SimTime t) const;
  // A vector of the world in the frame of the object's carrier, as that stands at t.
  [[nodiscard]] Vec3 in_frame_of_carrier(std::size_t object, SimTime t, const Vec3& world) const;
  // The law in force; of what is carried, its state in the world.
  [[nodiscard]] MotionModel world_law(std::size_t object, SimTime t) const;
  // The acceleration in the world that the object has where nothing bears it.
  [[nodiscard]] Vec3 free_acceleration_of(std::size_t object, SimTime t) const;
  // Whether the object's motion is part of what moves a side of a pair: that end, or that part of it.
  [[nodiscard]] bool is_in_side(std::size_t object, std::size_t end, std::uint32_t part) const;
  // Whether this peer moves the end, or what carries it.
  [[nodiscard]] bool is_lived(std::size_t end) const;
  // The instant from which on the end's way is known.
  [[nodiscard]] SimTime known_since(std::size_t end) const;

  [[nodiscard]] MovingPart moving_part(std::uint32_t part, const OwnChain& chain) const;
  // The bound of an object's body in the world, kept; one in the frame of `common`; that of a whole end as a box.
  [[nodiscard]] const SweptBound& bound_of(std::size_t object, SimTime s);
  [[nodiscard]] SweptBound make_bound(std::uint32_t part, std::uint32_t common, SimTime s) const;
  [[nodiscard]] SweptBound bound_of_end(std::size_t end, SimTime s);

  // The history of driven objects is kept for so long.
  void set_driven_history(Duration history) { driven_history_ = history; }
  [[nodiscard]] std::optional<Duration> driven_history() const { return driven_history_; }
  [[nodiscard]] Duration history_of(const MovingObject& o) const;
  void note_change(std::size_t object);
  // Called after any change of the object's timeline.
  void timeline_changed(std::size_t object);
  void prune_timelines(SimTime advanced);
  template <class Function>
  void take_changed(Function function) {
    for (const std::uint32_t i : changed_) {
      objects_[i].changed = false;
      function(objects_[i].id);
    }
    changed_.clear();
  }

 private:
  [[nodiscard]] std::uint32_t index_or_none(ObjectId id) const {
    const ModelNode* const node = model_->node(id);
    return node != nullptr ? static_cast<std::uint32_t>(node - model_->nodes.data()) : declared_.of(id);
  }
  // How an object that nobody has asked for stands in its carrier.
  [[nodiscard]] KinematicState state_in_file(const ModelNode& node) const;
  [[nodiscard]] std::optional<ObjectId> carrier_of(std::size_t index) const;
  [[nodiscard]] MovingObject made(const ModelNode& node, Role role) const;
  [[gnu::noinline]] MovingObject& make(std::size_t node) const;
  // The object goes on as one of another model.
  void continue_as(MovingObject& o, const MovingObject& before) const;
  // The instant at which a timeline is pruned of what is too old by then.
  struct Pruning {
    SimTime at;
    std::uint32_t object;
    bool operator>(const Pruning& other) const { return at > other.at; }
  };
  void schedule_pruning(std::size_t object);

  const WorldModel* model_;
  SimTime start_;
  FlexibleParts* flexible_ = nullptr;
  std::optional<Duration> driven_history_;      // none: as for all other objects
  mutable SparseTable<MovingObject> objects_;   // a question makes a node, too
  std::vector<Role> roles_;                     // also of what is not made
  ObjectTable<std::uint32_t> declared_{kNone};  // indices of what the model does not need
  std::vector<Pruning> prunings_;               // a heap, the earliest first
  std::vector<std::uint32_t> changed_;          // indices into objects_
};

}  // namespace peerd::replication
