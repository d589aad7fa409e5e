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

// What an object does in a MotionWorld when it touches something. Those from kAuthoritative on answer.
enum class Role : std::uint8_t {
  kScene,   // run by nobody: stays
  kDriven,  // moved by samples from outside; contacts are seen, not answered
  kAuthoritative,    // answers contacts, and what it answered stays (an object that this peer runs)
  kPredicted,  // answers contacts, but takes the answer back when its cause turns out to have moved otherwise
};

// Whose outcome of a contact counts.
enum class ContactAuthority : std::uint8_t {
  kAsPublished,   // this world's, but for an object whose owner has told of later: that holds it already
  kLocal,      // this world's: whoever has told of later was to leave it to this peer
  kDeferred  // the contact is told once, `held`, and the two go on
};

struct ContactEvent {
  SimTime at;  // the contact time, rounded down to a nanosecond so that nothing is inside anything
  ObjectId collider, collidee;
  Vec3 normal = Vec3::Zero();  // world frame, of the collidee's polygon, facing the collider
  KinematicState collider_before, collidee_before, collider_after, collidee_after;
  bool deferred = false;  // nobody answered: another peer decides. The states after are what it would come to here
};

// Contacts of `object` after `since` that were told are believed no more; those that still hold are told again.
struct ContactsRetracted {
  ObjectId object;
  SimTime since;
};

// Objects on timelines that meet each other at contact *times*. Results do not depend on how often advance() is called,
// nor on when what was told came: a pair's next contact is computed once, from an instant that their timelines decide,
// and kept until one of the pieces changes. Worlds with equal timelines find equal contacts, bit for bit.
//
// A tick costs what is due: pairs wait for the instant at which they need a look, objects for that at which something
// of theirs is to be forgotten. What no interest names costs nothing between two changes of how it moves.
class MotionWorld {
 public:
  struct Counters {
    std::uint64_t contact_searches = 0;  // calls into collision
    std::uint64_t searches_far = 0;      // spared those calls: where the two can be doesn't meet
    std::uint64_t searches_skipped = 0;  // pairs whose cached answer still stood
    std::uint64_t contacts = 0;
    std::uint64_t contacts_undone = 0;  // beliefs taken back
    std::uint64_t came_to_rest = 0;     // ever lower bounces ended by come_to_rest_against
    std::uint64_t jammed = 0;           // objects stopped because rest gave way to rest
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

  // How long where a driven object was is kept after the last advance(), > 0; 4 s at first, as of all others. Of one
  // that no interest names, nothing but what was told last is kept from then on: nobody meets it.
  void keep_history_of_driven(Duration history) {
    assert(history > Duration{0});
    driven_history_ = history;
  }

  // Asked at each contact.
  using AuthorityOf = std::function<ContactAuthority(ObjectId collider, ObjectId collidee, SimTime contact)>;
  void set_authority(AuthorityOf authority_of) { authority_of_ = std::move(authority_of); }

  // From t on, the object moves so: an update, a sample, a decision. t may lie in the past; beliefs that followed from
  // what is replaced are taken back and found anew by the next advance().
  void set_base(ObjectId object, SimTime t, const MotionModel& model);

  // For who tells many in turn: what set_base() will need of this one comes from memory meanwhile.
  [[gnu::always_inline]] inline void prefetch(ObjectId object) const {
    if (const Object* o = find(object)) peerd::prefetch(*o);
  }

  // Answers all contacts up to `to`, in time order.
  void advance(SimTime to);

  [[nodiscard]] bool has(ObjectId object) const { return find(object) != nullptr; }
  [[nodiscard]] std::vector<ObjectId> objects() const;
  [[nodiscard]] KinematicState at(ObjectId object, SimTime t) const;
  [[nodiscard]] MotionModel model_at(ObjectId object, SimTime t) const;
  // Whether it is known where it was at t: what ended more than 4 s before the last advance() (keep_driven) is not.
  [[nodiscard]] bool has_history_at(ObjectId object, SimTime t) const;
  // Since when the law that is in force at t is.
  [[nodiscard]] SimTime law_since(ObjectId object, SimTime t) const;
  // When the last told (not predicted) piece of its timeline began.
  [[nodiscard]] SimTime base_time(ObjectId object) const;
  // Whether it stands still from t on, for all that this world knows now.
  [[nodiscard]] bool is_at_rest_from(ObjectId object, SimTime t) const;
  // Hands over, each once and in any order, the objects whose way may have become another one since the last call.
  // `function` tells this world nothing.
  template <class Function>
  void take_changed(Function function) {
    for (const std::uint32_t i : changed_) {
      objects_[i].changed = false;
      function(objects_[i].id);
    }
    changed_.clear();
  }
  // Another number whenever its future became another one: it was told, or what it had answered was taken back.
  [[nodiscard]] std::uint64_t revision(ObjectId object) const;
  // What happened, in order; drain after advance().
  using Event = std::variant<ContactEvent, ContactsRetracted>;
  [[nodiscard]] std::optional<Event> poll_event();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Object {
    ObjectId id;
    Role role;
    Timeline timeline;
    SimTime base_time;
    std::vector<SimTime> recent;  // of its last contacts, for ever lower bounces
    std::uint64_t revision = 0;
    bool pruning_scheduled = false;  // it is in forgetting_
    bool changed = false;  // .. in changed_
    SweptBound bound;      // what was asked for last; it answers for nothing once the timeline changes
  };
  struct Pair {
    std::uint32_t collider, collidee;  // into objects_
    CollisionType type;
    bool collider_responds, collidee_responds;
    bool has_exact_search;  // collision has an answer
    bool watched = true;
    bool unsupported = false;        // told once, then left alone
    bool overlapped = false;         // `contact` is an overlap found, not a touch
    bool resting = false;            // `contact` is one pressed against the other, not one that comes in
    bool inside = false;             // a contact that nobody answers goes on; it is told once
    SimTime clear_until;             // no contact before this that is not already answered
    std::optional<SimTime> contact;  // the next one, at clear_until, if the search found one
    std::optional<SimTime> free_at;  // when the two were last known apart: setBack goes there
    Vec3 normal = Vec3::Zero();
    std::vector<SimTime> recent;  // of its last contacts, for those that answer by impulse
  };
  // When a timeline forgets what is too old by then.
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
  void search_window(Pair& pair);
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
  std::optional<Duration> driven_history_;  // none: as of all others
  std::vector<Object> objects_;             // the model's bodies, then what else was declared, as it came
  std::vector<std::uint32_t> index_by_id_;  // into objects_; kNone
  std::vector<Pair> pairs_;                 // the model's
  Schedule pair_checks_;                          // pairs: when the next look is due
  std::size_t watched_ = 0;                 // pairs in looks_, whenever that is
  std::vector<bool> in_pair_checks_;
  std::vector<Pruning> prunings_;  // a heap, the earliest first
  std::vector<std::uint32_t> changed_;  // objects
  AuthorityOf authority_of_;                   // none: as told
  std::vector<Event> events_;
  std::size_t polled_ = 0;  // of events_
  Counters counters_;
};

}  // namespace peerd::replication
