#pragma once
#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include <boost/container/small_vector.hpp>

#include "collision/contact/contact_time.hpp"
#include "core/least_change.hpp"
#include "core/prefetch.hpp"
#include "core/schedule.hpp"
#include "core/time.hpp"
#include "replication/motion/composed_motion.hpp"
#include "replication/motion/swept_bound.hpp"
#include "replication/motion/timeline.hpp"
#include "replication/world/part_contact.hpp"
#include "replication/world/response.hpp"
#include "replication/world/world_model.hpp"

namespace peerd::replication {

// The role of an object in a MotionWorld: what it does in a contact. Roles from kAuthoritative on respond.
enum class Role : std::uint8_t {
  kScene,   // owned by nobody; a script may move it, and it does not respond (a scene object that does: kPredicted)
  kDriven,  // moved by samples from outside; its contacts are reported, and it does not respond
  kAuthoritative,  // responds to contacts, and its responses are final (an object that this peer owns)
  kPredicted,      // responds to contacts; a response is retracted when its cause turns out to have moved otherwise
};

// The authority in a contact: the outcome that counts.
enum class ContactAuthority : std::uint8_t {
  kAsPublished,  // this world's, but for an object with an update of a later time, which contains the outcome
  kLocal,        // this world's, also for an object with a later update: its owner leaves the decision to this peer
  kDeferred      // the contact is reported once, as deferred, and the two objects go on
};

struct ContactEvent {
  SimTime at;  // the contact time, rounded down to a nanosecond so that nothing is inside anything
  ObjectId collider, collidee;
  Vec3 normal = Vec3::Zero();  // in the world frame: of the collidee's polygon, facing the collider
  KinematicState collider_before, collidee_before, collider_after, collidee_after;
  CollisionType type = CollisionType::kWitness;  // of the interest
  bool deferred = false;  // nobody responded: another peer decides; the states after are what the outcome would be here
};

// Two bodies overlap when they are looked at for the first time, as soon as one of them moves. They part as they will;
// if they approach or are pressed together, that is answered once, by their responses.
struct BodiesOverlap {
  SimTime at;
  ObjectId collider, collidee;
};

// Contacts of `object` after `since` that were reported are retracted; those that still hold are reported again.
struct ContactsRetracted {
  ObjectId object;
  SimTime since;
  std::optional<ObjectId> partner{};  // only contacts with it are retracted; none: those with anything
  bool of_ghosts_alone = false;       // contacts that an owner has found with its own objects stand

  // Whether a contact of those two at that time is one of them.
  [[nodiscard]] bool retracts(SimTime at, ObjectId a, ObjectId b) const {
    if (at <= since || (a != object && b != object)) return false;
    return !partner || a == *partner || b == *partner;
  }
};

// Objects on timelines that meet each other at contact *times*. The timeline of what is below a carrier is relative to
// it (composed_motion.hpp): what is set and asked as a law is in the frame of the carrier, and states are in the world.
// An end of an interest meets others with each of its parts, those that carriers below it move included. Results depend
// neither on how often advance() is called, nor on when updates came: a pair's next contact is computed once, from an
// instant that the two timelines decide, and kept until one of the pieces changes. Worlds with equal timelines find
// equal contacts, bit for bit.
//
// Two that meet and would part for less than kShortestFlight_s come to rest against each other: from then on the one
// bears the other. Bearing takes from an object's free acceleration what leads into what bears it; when that goes, or
// the object slides off or is lifted, the rest comes back. What bears what is solved for all that rest on each other at
// once (least_change.hpp).
//
// Contacts of one instant are answered in turn; each later one sees what the earlier ones have changed, and none is
// undone for it. Where that does not end (contacts a nanosecond apart; a ball between a wall and a driven car that
// comes, ever faster), those that met within kShortestFlight_s are answered at once, without restitution, and what has
// no room left stops. No answer of two objects that both respond adds energy (response.hpp).
//
// A tick costs what is due: pairs wait for the instant at which they need a check, objects for that at which their
// timelines are pruned. An object that no interest names costs nothing between two changes of its motion.
class MotionWorld {
 public:
  struct Counters {
    std::uint64_t contact_searches = 0;  // calls into collision
    std::uint64_t searches_far = 0;      // searches without such a call, because the bounds of the two are apart
    std::uint64_t searches_skipped = 0;  // pairs whose cached answer still stood
    std::uint64_t contacts = 0;
    std::uint64_t contacts_undone = 0;  // predicted contacts that were retracted
    std::uint64_t came_to_rest = 0;     // contacts in which two came to rest against each other
    std::uint64_t jammed = 0;           // contacts answered for all that touched, because no answer for two ended them
    std::uint64_t overlapped = 0;       // searches that began inside another object
    std::uint64_t unsupported = 0;      // pairs that collision can't answer yet
    std::uint64_t failed = 0;           // searches that hit their iteration cap
    std::uint64_t capped = 0;           // advance() had found kContactsMax contacts and stopped all that met any more

    Counters& operator+=(const Counters& other);
  };

  // Timelines keep this much of the past, for updates and decisions that arrive late.
  static constexpr Duration kHistory = std::chrono::seconds(6);

  MotionWorld(const WorldModel& model, SimTime start);

  // Declares an object that may move; every body that is not declared stays at its place in the file.
  void declare(ObjectId object, Role role);
  // Gives the world the places of flexible parts; `flexible` outlives it. Without them their pairs are not searched.
  void set_flexible(FlexibleParts& flexible);
  // World time has another beginning: contacts of flexible parts from t on are searched anew.
  void reopen_flexible(SimTime t);
  // Turns watching of a pair on or off; all pairs start watched.
  void watch(ObjectId a, ObjectId b, bool on);
  void watch(std::uint32_t number, bool on);  // in WorldModel::pairs

  // Keeps the positions of driven objects for so long before the last advance(), > 0; kHistory at first, as for all
  // other objects. Of a driven object that no interest names, nothing but its last sample is kept from then on: nothing
  // meets it.
  void keep_history_of_driven(Duration history) {
    assert(history > Duration{0});
    driven_history_ = history;
  }

  // The function is asked at each contact.
  using AuthorityOf = std::function<ContactAuthority(ObjectId collider, ObjectId collidee, SimTime contact)>;
  void set_authority(AuthorityOf authority_of) { authority_of_ = std::move(authority_of); }

  // Sets the object's motion from t on, in the frame of its carrier, after an update, a sample or a decision. t may lie
  // in the past: the predictions that followed from the replaced motion are retracted, and the next advance() finds
  // them anew.
  void set_base(ObjectId object, SimTime t, const MotionModel& model);

  // The acceleration [m/s^2, world frame] that the object has where nothing bears it: from then on, and in
  // whatever motion set_base() gives it. Without it that of the law under which it came to rest counts.
  void set_free_acceleration(ObjectId object, const Vec3& acceleration);
  [[nodiscard]] std::optional<Vec3> free_acceleration(ObjectId object) const;

  // For a caller that sets many objects in turn: fetches from memory what set_base() will need of this one.
  [[gnu::always_inline]] inline void prefetch(ObjectId object) const {
    if (const Object* o = find(object)) peerd::prefetch(*o);
  }

  // Finds all contacts up to `to`, in time order, and responds to them.
  void advance(SimTime to);
  // Finds anew what a set_base() in the past has made void, until the last advance(): states until then are right
  // again.
  void catch_up() { advance(advanced_); }

  [[nodiscard]] bool has(ObjectId object) const { return find(object) != nullptr; }
  [[nodiscard]] std::vector<ObjectId> objects() const;
  // The state in the world.
  [[nodiscard]] KinematicState at(ObjectId object, SimTime t) const;
  // The state in the frame of the object's carrier; that in the world where it has none.
  [[nodiscard]] KinematicState relative_at(ObjectId object, SimTime t) const;
  [[nodiscard]] bool is_carried(ObjectId object) const;
  // A vector of the world in the frame of the object's carrier, as that stands at t; and back.
  [[nodiscard]] Vec3 vector_in_carrier(ObjectId object, SimTime t, const Vec3& world) const;
  [[nodiscard]] Vec3 vector_in_world(ObjectId object, SimTime t, const Vec3& relative) const;
  // The law in force, in the frame of the object's carrier.
  [[nodiscard]] MotionModel model_at(ObjectId object, SimTime t) const;
  // A state in the world as one in the frame of the object's carrier, as that is at t; and back.
  [[nodiscard]] KinematicState in_carrier(ObjectId object, SimTime t, const KinematicState& world) const;
  [[nodiscard]] KinematicState in_world(ObjectId object, SimTime t, const KinematicState& relative) const;
  // Whether the position of the object at t is known: that of more than kHistory before the last advance() is not (see
  // keep_history_of_driven).
  [[nodiscard]] bool has_history_at(ObjectId object, SimTime t) const;
  // The instant at which the law that is in force at t began.
  [[nodiscard]] SimTime law_since(ObjectId object, SimTime t) const;
  // The instant of the last update, sample or decision of the object; later predicted pieces do not move it.
  [[nodiscard]] SimTime base_time(ObjectId object) const;
  // Whether the object stands still from t on, by all that this world knows now.
  [[nodiscard]] bool is_at_rest_from(ObjectId object, SimTime t) const;
  // Whether the object stands still in its carrier from t on, by all that this world knows now.
  [[nodiscard]] bool stands_in_carrier_from(ObjectId object, SimTime t) const;
  // Whether the law in force at t is an answer to a contact.
  [[nodiscard]] bool is_moved_by_contact(ObjectId object, SimTime t) const {
    return objects_[index_of(object)].timeline.segment_at(t).cause.has_value();
  }
  // Calls `function` for the objects whose motion may have changed since the last call, each once and in any order.
  // `function` must not change this world.
  template <class Function>
  void take_changed(Function function) {
    for (const std::uint32_t i : changed_) {
      objects_[i].changed = false;
      function(objects_[i].id);
    }
    changed_.clear();
  }
  // A number that changes whenever the future of the object does: by set_base(), or when a response was retracted.
  [[nodiscard]] std::uint64_t revision(ObjectId object) const;
  // Whether two ends of interests touch at t, up to which this world has been advanced, or are nearer than contact
  // times leave them.
  [[nodiscard]] bool ends_touch(ObjectId a, ObjectId b, SimTime t);
  // The events so far, in order; drain after advance().
  using Event = std::variant<ContactEvent, ContactsRetracted, BodiesOverlap>;
  [[nodiscard]] std::optional<Event> poll_event();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Object {
    ObjectId id;
    Role role;
    Timeline timeline;
    SimTime base_time;
    std::uint64_t revision = 0;
    bool answers = false;                      // contacts of some pair
    bool pruning_scheduled = false;            // it is in prunings_
    bool changed = false;                      // it is in changed_
    bool borne = false;                        // its law's acceleration is what those that bear it leave of `free`
    bool free_is_given = false;                // by set_free_acceleration()
    Vec3 free = Vec3::Zero();                  // its acceleration where nothing bears it [m/s^2]; void if it is neither
    std::uint32_t carrier = ModelNode::kNone;  // index; its timeline is relative to that object's
    SweptBound bound;  // of its body: the last one; it answers for nothing once the timeline changes
  };
  // Two parts of two ends of an interest (PartPair). What answers is the end.
  struct Pair {
    std::uint32_t collider, collidee;  // the ends, into objects_
    std::uint32_t part_a, part_b;      // the model's parts that meet; kNone: the boxes of both whole ends
    std::uint32_t common;              // the two meet in the frame of that object; kNone: in the world
    std::uint32_t number;              // of the interest's pair, in the model
    CollisionType type;
    bool fixed;
    bool is_plain;  // the parts are the ends, and nothing carries them
    bool is_flexible;
    bool collider_responds, collidee_responds;
    bool has_exact_search;  // collision has an answer
    bool watched = true;
    bool unsupported = false;             // counted once, then never searched again
    bool searched = false;                // some search has been answered
    bool overlapped = false;              // `contact` is an overlap, not a touch
    bool resting = false;                 // at `contact` the two are pressed together and do not approach
    bool lifts = false;                   // at `contact` the two come apart: they bore each other until then
    std::optional<bool> fixed_touch{};    // whether the two, which are fixed to each other, touch; none: not known yet
    bool inside = false;                  // a contact without a response goes on; it is reported once
    bool bears = false;                   // the two rest against each other, along all of `normals`
    SimTime parted = SimTime::min();      // when `inside` was last over
    SimTime touched = SimTime::min();     // of the last contact
    SimTime lifted = SimTime::min();      // when the two last came apart after they bore each other
    SimTime held_until = SimTime::min();  // the two do not come apart before
    std::uint32_t at_once = 0;            // contacts until `touched`, each at the instant of the one before
    std::uint32_t in_burst = 0;           // contacts until `touched`, each within kShortestFlight_s of the one before
    std::uint32_t squeezed = 0;           // of the burst: those answered for all that touched
    SimTime clear_until;                  // all contacts before this have been dealt with
    std::optional<SimTime> contact;       // the next contact, at clear_until, if the search found one
    std::optional<SimTime> free_at;  // the last instant at which the two were known to be apart: setBack goes there
    Vec3 normal = Vec3::Zero();      // of `contact`
    std::vector<Vec3> normals;       // of the contacts of the burst, and those along which the two bear each other
  };
  // The instant at which a timeline is pruned of what is too old by then.
  struct Pruning {
    SimTime at;
    std::uint32_t object;
    bool operator>(const Pruning& other) const { return at > other.at; }
  };

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  [[nodiscard]] const Object* find(ObjectId id) const {
    const bool known = id.value < index_by_id_.size() && index_by_id_[id.value] != kNone;
    return known ? &objects_[index_by_id_[id.value]] : nullptr;
  }
  [[nodiscard]] std::size_t index_of(ObjectId id) const {
    assert(find(id) != nullptr);
    return index_by_id_[id.value];
  }
  // The pairs of which the object is an end; those that its own motion may change; what goes with it.
  [[nodiscard]] std::span<const std::uint32_t> pairs_of(std::size_t object) const;
  [[nodiscard]] std::span<const std::uint32_t> pairs_moved_by(std::size_t object) const;
  [[nodiscard]] std::span<const std::uint32_t> carried_by(std::size_t object) const;
  [[nodiscard]] const collision::Body& body(std::size_t object) const { return model_.bodies[object]; }
  [[nodiscard]] static bool will_respond(const Object& o, bool registered, SimTime t);
  // The timelines from below `common` down to the object's own.
  using OwnChain = boost::container::small_vector<const Timeline*, 4>;
  [[nodiscard]] OwnChain chain_of(std::uint32_t object, std::uint32_t common = kNone) const;
  [[nodiscard]] KinematicState world_at(std::size_t object, SimTime t) const;
  [[nodiscard]] KinematicState carrier_at(std::size_t object, SimTime t) const;
  // A vector of the world in the frame of the object's carrier, as that stands at t.
  [[nodiscard]] Vec3 in_frame_of_carrier(std::size_t object, SimTime t, const Vec3& world) const;
  // The law in force; of what is carried, its state in the world.
  [[nodiscard]] MotionModel world_law(std::size_t object, SimTime t) const;
  // Whether the object's motion is part of what moves a side of a pair: that end, or that part of it.
  [[nodiscard]] bool is_in_side(std::size_t object, std::size_t end, std::uint32_t part) const;
  // Whether this peer moves the end, or what carries it.
  [[nodiscard]] bool is_lived(std::size_t end) const {
    for (auto i = static_cast<std::uint32_t>(end); i != kNone; i = objects_[i].carrier) {
      if (objects_[i].role == Role::kAuthoritative || objects_[i].role == Role::kDriven) return true;
    }
    return false;
  }
  // The instant from which on the end's way is known.
  [[nodiscard]] SimTime known_since(std::size_t end) const {
    SimTime known = objects_[end].timeline.begin();
    for (std::uint32_t i = objects_[end].carrier; i != kNone; i = objects_[i].carrier) {
      known = std::max(known, objects_[i].timeline.begin());
    }
    return known;
  }
  [[nodiscard]] static bool is_answered(const Pair& pair) { return pair.collider_responds || pair.collidee_responds; }
  // The bound of an object's body in the world, kept; one in the frame of `common`; that of a whole end as a box; that
  // of a side of a pair.
  [[nodiscard]] const SweptBound& bound_of(std::size_t object, SimTime s);
  [[nodiscard]] SweptBound make_bound(std::uint32_t part, std::uint32_t common, SimTime s) const;
  [[nodiscard]] MovingPart moving_part(std::uint32_t part, const OwnChain& chain) const;
  [[nodiscard]] SweptBound bound_of_end(std::size_t end, SimTime s);
  [[nodiscard]] SweptBound bound_of_side(const Pair& pair, bool of_collider, SimTime s);
  template <class Function>
  [[nodiscard]] auto with_query(const Pair& pair, Function function) const;
  [[nodiscard]] bool ends_touch_elsewhere(const Pair& pair, SimTime t);
  [[nodiscard]] bool fixed_parts_touch(Pair& pair, SimTime t) const;
  [[nodiscard]] bool goes_on(Pair& pair, SimTime s, SimTime end);
  void add_object(const ModelNode& node);
  [[nodiscard]] std::optional<std::size_t> first_contact_until(SimTime to);
  void search(Pair& pair, SimTime to);
  // Searches the time in which both objects keep their pieces, or until the next multiple of kLookahead.
  void search_window(Pair& pair);
  void search_window(Pair& pair, const SweptBound& bound_a, const SweptBound& bound_b);
  void search_composed_window(Pair& pair);
  // Searches for the first contact from `begin` on; contacts before pair.clear_until have been dealt with.
  void search_interval(Pair& pair, SimTime begin, SimTime end);
  // The two are known to be apart at s.
  void note_apart(Pair& pair, SimTime s);
  void reschedule(std::size_t pair);
  [[nodiscard]] Duration history_of(const Object& o) const;
  void note_change(std::size_t object);
  void timeline_changed(std::size_t object);
  void schedule_pruning(std::size_t object);
  void prune_timelines();
  // The answers of the two objects of a pair to its contact.
  struct Answer {
    ContactAuthority authority;
    MotionModel before_a, before_b, after_a, after_b;
    bool a_responds, b_responds;
  };
  void respond_to_contact(Pair& pair);
  [[nodiscard]] Answer answer_to(const Pair& pair) const;
  [[nodiscard]] MotionModel motion_after_response(std::size_t object, const Pair& pair, const MotionModel& self,
                                                  const KinematicState& other, OtherSide other_side,
                                                  const Vec3& n) const;
  [[nodiscard]] bool comes_to_rest_at(const Pair& pair, const Answer& answer) const;
  void answer_closing(const Pair& pair, Answer& answer) const;
  void remove_gain(const Pair& pair, SimTime t, const Answer& answer);
  void report(const Pair& pair, SimTime t, const Answer& answer);
  // The object moves otherwise from t on, because of a contact with `cause`. The law is in the world; what is carried
  // keeps its state, and goes on in the frame of its carrier.
  void change_motion(std::size_t object, SimTime t, const MotionModel& after_in_world, ObjectId cause);

  // Objects that touch each other at one instant, as far as they give way, and what they give way to.
  struct Island {
    std::vector<std::uint32_t> objects;  // of `bodies`: into objects_, or kNone for one that does not give way
    std::vector<ConstrainedBody> bodies;
    std::vector<OneSided> constraints;
    std::vector<std::uint32_t> pairs;  // of each constraint
  };
  enum class Touching : std::uint8_t { kBearing, kAny };  // the pairs that bear, or all of the burst
  enum class Quantity : std::uint8_t { kVelocity, kAcceleration };
  [[nodiscard]] Island island_of(std::size_t a, std::size_t b, SimTime t, Touching which, Quantity quantity) const;
  // The values become those that the constraints allow. Returns the pairs that had to be left out: of them one comes
  // and gives way to nothing, and the other has no room.
  [[nodiscard]] static std::vector<std::uint32_t> solve(Island& island);
  void note_touch(Pair& pair, SimTime t);
  // The two come to rest against each other at t.
  void come_to_rest(Pair& pair, SimTime t);
  // Whether answers for two do not end the contacts around the pair.
  [[nodiscard]] bool is_squeezed(const Pair& pair, SimTime t) const;
  // Whether what gives way to nothing comes into those that met within the burst around the pair.
  [[nodiscard]] bool is_driven(const Pair& pair, SimTime t) const;
  // All that met within the burst are answered at once.
  void answer_squeezed(Pair& pair, SimTime t);
  void stop(Pair& pair, SimTime t);
  // Whether one of the two gives way and the other stands: a wall, for all that this contact knows.
  [[nodiscard]] bool stands_firm(const Pair& pair, SimTime t) const;
  // What is pressed into a wall without end stops there, and what presses it goes through it.
  void hold_against_wall(Pair& pair, SimTime t);
  // Gives all that rest on each other around the two the velocities and accelerations that their bearing leaves.
  void settle(std::size_t a, std::size_t b, SimTime t);
  void settle_velocities(Pair& pair, SimTime t, Touching which);
  // Of a spin that is not about the normal of a contact, the part about it [rad/s, of the body]; nothing where the spin
  // is about it, or the body a Sphere, none of which presses corners into what it touches.
  [[nodiscard]] std::optional<Vec3> rolling_off(std::size_t object, const KinematicState& state,
                                                const Vec3& normal) const;
  // Of the spin of a body that rests against another along that normal what is about the normal is left: its corners
  // would press into the other.
  void end_rolling(std::size_t object, SimTime t, const Vec3& normal, std::size_t cause);
  void change_velocity(std::size_t object, SimTime t, const Vec3& velocity, std::size_t cause);
  void release_parting(std::size_t object, SimTime t);
  void lift(Pair& pair, SimTime t);
  // The two bear each other and move: whether, and when, they come apart until `end`.
  void search_lift(Pair& pair, SimTime begin, SimTime end);
  [[nodiscard]] bool touch_at(const Pair& pair, SimTime t) const;
  [[nodiscard]] bool gives_way(std::size_t object, bool registered, SimTime t) const {
    return will_respond(objects_[object], registered, t);
  }
  // Whether physics moves the object, and it answers contacts of some pair.
  [[nodiscard]] static bool is_answering(const Object& o) { return o.role >= Role::kAuthoritative && o.answers; }
  // Whether the later update of an object that does not respond to a contact holds its part of it: its owner has seen
  // the first contact of the burst. What this peer owns has had none that this world does not know.
  [[nodiscard]] static bool is_in_later_update(const Object& o, const Pair& pair) {
    return o.role == Role::kPredicted && pair.in_burst <= 1;
  }
  [[nodiscard]] Vec3 free_acceleration_of(std::size_t object, SimTime t) const;

  void retract_contacts_of_carried(std::size_t object, SimTime t);
  void retract(std::size_t cause, SimTime t);
  // What was counted of contacts since then is void.
  void forget_bursts(std::size_t object, SimTime t);
  // The object's pieces changed from t on. `elsewhere`: also where it is.
  void reopen_pairs(std::size_t object, SimTime t, bool elsewhere);

  const WorldModel& model_;
  SimTime start_, advanced_;
  FlexibleParts* flexible_ = nullptr;
  std::optional<Duration> driven_history_;  // none: as for all other objects
  std::vector<Object> objects_;  // the model's nodes, then the other declared objects in order of declaration
  std::vector<std::uint32_t> index_by_id_;  // indices into objects_, or kNone
  std::vector<Pair> pairs_;                 // the model's part pairs
  Schedule pair_checks_;                    // for each pair, when the next check is due
  std::size_t watched_ = 0;                 // the number of pairs with a check, whenever that is due
  std::vector<bool> in_pair_checks_;
  std::vector<Pruning> prunings_;       // a heap, the earliest first
  std::vector<std::uint32_t> changed_;  // indices into objects_
  AuthorityOf authority_of_;            // none: kAsPublished for all
  std::vector<Event> events_;
  std::size_t polled_ = 0;  // of events_
  Counters counters_;
};

}  // namespace peerd::replication
