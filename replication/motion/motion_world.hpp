#pragma once
#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "collision/contact/contact_time.hpp"
#include "core/prefetch.hpp"
#include "core/time.hpp"
#include "replication/motion/schedule.hpp"
#include "replication/motion/swept_bound.hpp"
#include "replication/motion/timeline.hpp"
#include "replication/motion/world_model.hpp"

namespace peerd::replication {

// The role of an object in a MotionWorld: what it does in a contact. Roles from kAuthoritative on respond.
enum class Role : std::uint8_t {
  kScene,          // owned by nobody: it stays
  kDriven,         // moved by samples from outside; its contacts are reported, and it does not respond
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
  bool deferred = false;  // nobody responded: another peer decides; the states after are what the outcome would be here
};

// Contacts of `object` after `since` that were reported are retracted; those that still hold are reported again.
struct ContactsRetracted {
  ObjectId object;
  SimTime since;
};

// Objects on timelines that meet each other at contact *times*. Results depend neither on how often advance() is
// called, nor on when updates came: a pair's next contact is computed once, from an instant that the two timelines
// decide, and kept until one of the pieces changes. Worlds with equal timelines find equal contacts, bit for bit.
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
    std::uint64_t came_to_rest = 0;     // ever lower bounces ended by come_to_rest_against
    std::uint64_t jammed = 0;           // objects stopped because they were squeezed between others
    std::uint64_t overlapped = 0;       // searches that began inside another object
    std::uint64_t unsupported = 0;      // pairs that collision can't answer yet
    std::uint64_t failed = 0;           // searches that hit their iteration cap
    std::uint64_t capped = 0;           // advance() gave up after kContactsMax contacts

    Counters& operator+=(const Counters& other);
  };

  // Pairs between two kScene objects are not watched.
  MotionWorld(const WorldModel& model, SimTime start);

  // Declares an object that may move; every body that is not declared stays at its place in the file.
  void declare(ObjectId object, Role role);
  // Turns watching of a pair on or off; all pairs start watched.
  void watch(ObjectId a, ObjectId b, bool on);
  void watch(std::uint32_t number, bool on);  // in WorldModel::pairs

  // Keeps the positions of driven objects for so long before the last advance(), > 0; 4 s at first, as for all other
  // objects. Of a driven object that no interest names, nothing but its last sample is kept from then on: nothing
  // meets it.
  void keep_history_of_driven(Duration history) {
    assert(history > Duration{0});
    driven_history_ = history;
  }

  // The function is asked at each contact.
  using AuthorityOf = std::function<ContactAuthority(ObjectId collider, ObjectId collidee, SimTime contact)>;
  void set_authority(AuthorityOf authority_of) { authority_of_ = std::move(authority_of); }

  // Sets the object's motion from t on, after an update, a sample or a decision. t may lie in the past: the predictions
  // that followed from the replaced motion are retracted, and the next advance() finds them anew.
  void set_base(ObjectId object, SimTime t, const MotionModel& model);

  // For a caller that sets many objects in turn: fetches from memory what set_base() will need of this one.
  [[gnu::always_inline]] inline void prefetch(ObjectId object) const {
    if (const Object* o = find(object)) peerd::prefetch(*o);
  }

  // Finds all contacts up to `to`, in time order, and responds to them.
  void advance(SimTime to);

  [[nodiscard]] bool has(ObjectId object) const { return find(object) != nullptr; }
  [[nodiscard]] std::vector<ObjectId> objects() const;
  [[nodiscard]] KinematicState at(ObjectId object, SimTime t) const;
  [[nodiscard]] MotionModel model_at(ObjectId object, SimTime t) const;
  // Whether the position of the object at t is known: that of more than 4 s before the last advance() is not (see
  // keep_history_of_driven).
  [[nodiscard]] bool has_history_at(ObjectId object, SimTime t) const;
  // The instant at which the law that is in force at t began.
  [[nodiscard]] SimTime law_since(ObjectId object, SimTime t) const;
  // The instant of the last update, sample or decision of the object; later predicted pieces do not move it.
  [[nodiscard]] SimTime base_time(ObjectId object) const;
  // Whether the object stands still from t on, by all that this world knows now.
  [[nodiscard]] bool is_at_rest_from(ObjectId object, SimTime t) const;
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
  // The events so far, in order; drain after advance().
  using Event = std::variant<ContactEvent, ContactsRetracted>;
  [[nodiscard]] std::optional<Event> poll_event();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Object {
    ObjectId id;
    Role role;
    Timeline timeline;
    SimTime base_time;
    std::vector<SimTime> recent;  // the times of its last contacts, to find ever lower bounces
    std::uint64_t revision = 0;
    bool pruning_scheduled = false;  // it is in prunings_
    bool changed = false;            // it is in changed_
    SweptBound bound;                // the last bound; it answers for nothing once the timeline changes
  };
  struct Pair {
    std::uint32_t collider, collidee;  // into objects_
    CollisionType type;
    bool collider_responds, collidee_responds;
    bool has_exact_search;  // collision has an answer
    bool watched = true;
    bool unsupported = false;        // counted once, then never searched again
    bool overlapped = false;         // `contact` is an overlap, not a touch
    bool resting = false;            // at `contact` the two are pressed together and do not approach
    bool inside = false;             // a contact without a response goes on; it is reported once
    SimTime clear_until;             // all contacts before this have been dealt with
    std::optional<SimTime> contact;  // the next contact, at clear_until, if the search found one
    std::optional<SimTime> free_at;  // the last instant at which the two were known to be apart: setBack goes there
    Vec3 normal = Vec3::Zero();
    std::vector<SimTime> recent;  // the times of its last contacts, for objects that respond by impulse
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
  [[nodiscard]] std::span<const std::uint32_t> pairs_of(std::size_t object) const;
  [[nodiscard]] const collision::Body& body(std::size_t object) const { return model_.bodies[object]; }
  [[nodiscard]] static bool will_respond(const Object& o, bool registered, SimTime t);
  [[nodiscard]] const SweptBound& bound_of(std::size_t object, SimTime s);
  void search(Pair& pair, SimTime to);
  // Searches the time in which both objects keep their pieces, or until the next multiple of kLookahead.
  void search_window(Pair& pair);
  // Searches for the first contact from `begin` on; contacts before pair.clear_until have been dealt with.
  void search_interval(Pair& pair, SimTime begin, SimTime end);
  void reschedule(std::size_t pair);
  [[nodiscard]] Duration history_of(const Object& o) const;
  void note_change(std::size_t object);
  void timeline_changed(std::size_t object);
  void schedule_pruning(std::size_t object);
  void prune_timelines();
  void respond_to_contact(Pair& pair);
  [[nodiscard]] MotionModel motion_after_response(std::size_t object, const Pair& pair, const MotionModel& self,
                                                  const KinematicState& other, bool other_responds, const Vec3& n);
  void retract(std::size_t cause, SimTime t);
  void reopen_pairs(std::size_t object, SimTime t);
  void clear_bounces(std::size_t object, SimTime from);

  const WorldModel& model_;
  SimTime start_, advanced_;
  std::optional<Duration> driven_history_;  // none: as for all other objects
  std::vector<Object> objects_;  // the model's bodies, then the other declared objects in order of declaration
  std::vector<std::uint32_t> index_by_id_;  // indices into objects_, or kNone
  std::vector<Pair> pairs_;                 // in the order of the model
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
