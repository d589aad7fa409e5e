#pragma once
#include <cassert>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/prefetch.hpp"
#include "core/schedule.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/timeline.hpp"
#include "replication/physics/world/contact_answer.hpp"
#include "replication/physics/world/contact_island.hpp"
#include "replication/physics/world/far_pairs.hpp"
#include "replication/physics/world/motion_event.hpp"
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/pair_search.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// Objects on timelines that meet each other at contact *times*. The timeline of what is below a carrier is relative to
// it (composed_motion.hpp): what is set and asked as a law is in the frame of the carrier, and states are in the world.
// An end of an interest meets others with each of its parts, those that carriers below it move included. Results depend
// neither on how often advance() is called, nor on when updates came: a pair's next contact is computed once, from an
// instant that the two timelines decide, and kept until one of the pieces changes. Worlds with equal timelines find
// equal contacts, bit for bit. One thing does depend on the order in which laws came, unless bases are replayed: what
// an object answered before the last law that was set stays, though that turns out to have had no cause, and it answers
// nothing more before that law.
//
// Two that meet and would part for less than kShortestFlight_s come to rest against each other: from then on the one
// bears the other. Bearing takes from an object's free acceleration what leads into what bears it; when that goes, or
// the object slides off or is lifted, the rest comes back. What bears what is solved for all that rest on each other at
// once (least_change.hpp).
//
// A contact in which one of the two bears something else strikes all that bear each other at once. All other contacts
// of one instant are answered in turn; each later one sees what the earlier ones have changed, and none is undone for
// it. A ball between a wall and a driven car that approaches, or between two objects that stand a few micrometres from
// it, would bounce without end. So objects that met within kShortestFlight_s are answered together, without
// restitution, and an object that has no room left stops. No answer of two objects that both respond adds energy
// (response.hpp).
//
// A tick costs what is due: pairs wait for the instant at which they need a check, objects for that at which their
// timelines are pruned. An object that no interest names costs nothing between two changes of its motion. Two that have
// never moved, and are apart in the file, cost a few bytes, however many interests name them.
class MotionWorld {
 public:
  using Counters = MotionCounters;

  // Timelines keep this much of the past, for updates and decisions that arrive late.
  static constexpr Duration kHistory = MovingObjects::kHistory;

  // Which pairs are watched at first.
  enum class Watched : std::uint8_t { kAll, kNone };

  MotionWorld(const WorldModel& model, SimTime start, Watched first = Watched::kAll);
  // Goes on with another model of the same scene, in which more nodes are carriers (extended()); the model before is
  // not needed any more. What goes with a new carrier stood still relative to it until now. Parts that are new are
  // searched from the last advance() on. No pair is put off.
  void change_model(const WorldModel& next);
  // Goes on with the model of the scene that edits have made of this one, from an instant on that may lie in the past:
  // what followed from what is gone, or not as it was, is retracted, and the next advance() finds contacts with what is
  // new. What nothing moves takes the place that the scene gives it. The model before is not needed any more. No pair
  // is put off. Returns the objects that have another place, or another carrier, because of it.
  std::vector<MovingObjects::Placed> change_scene(const WorldModel& next, const SceneChange& change);

  // Declares an object that may move; every body that is not declared stays at its place in the file.
  void declare(ObjectId object, Role role);
  // Gives the world the places of flexible parts; `flexible` outlives it. Without them their pairs are not searched.
  void set_flexible(FlexibleParts& flexible);
  // Contacts are found at ticks from now on, by the engine of `detection`, which outlives the world; called before the
  // first advance(). Without it they are found at contact times.
  void set_tick_detection(TickDetection& detection) { detection_ = &detection; }
  // World time has another beginning: contacts of flexible parts from t on are searched anew.
  void reopen_flexible(SimTime t);
  // Which pairs are watched from now on: the rule is asked as pairs come near each other. Where it says otherwise of a
  // pair than before, watch_anew() follows.
  void watch_by(IsWatched is_watched);
  // Asks the rule again of all pairs, or of those of an object.
  void watch_anew(std::optional<ObjectId> object = {});

  // The part pairs that are near or put off, or were so since the first call, and all watched ones of which one of the
  // two has moved; all pairs where there is no rule. Those of the last call come first, in the same order, unless the
  // model has changed since.
  [[nodiscard]] std::span<const std::uint32_t> known_pairs();

  // Makes the world a function of the bases, whatever order they come in; called before the first of them. An object
  // then answers contacts of before its later bases, too, and what it has answered without cause is retracted;
  // advance() lays its later bases again. Costs the memory of the bases of the last kHistory, of what may meet
  // anything.
  void replay_bases() { replays_bases_ = true; }

  // Puts the searches of a part pair (WorldModel::part_pairs) off, or takes them up again. A pair that is put off is
  // followed while bounds keep the two apart, and stops where collision would be asked. Taken up, it is searched from
  // there: later than never having stopped, with the same results; not before the last bases of all that would answer,
  // which contain the outcome; and where nobody would answer, or `from_now`, from the last advance() on. Two that bear
  // each other are not put off.
  void put_off(std::uint32_t part_pair, bool on, bool from_now = false);
  // The part pairs that have stopped, ascending, and since when the contacts of such a pair are not known.
  [[nodiscard]] const std::set<std::uint32_t>& stopped() const { return stopped_; }
  [[nodiscard]] SimTime stopped_since(std::uint32_t part_pair) const {
    assert(stopped_.contains(part_pair));
    return pairs_[part_pair].clear_until;
  }

  // Keeps the positions of driven objects for so long before the last advance(), > 0; kHistory at first, as for all
  // other objects. Of a driven object that no interest names, nothing but its last sample is kept from then on: nothing
  // meets it.
  void keep_history_of_driven(Duration history) {
    assert(history > Duration{0});
    objects_.set_driven_history(history);
  }

  // `of` is asked at each contact: none, kAsPublished for all. `alone`, of what a crowd foresees, says whether no peer
  // has to agree with others on a contact of the two: none, true for all.
  using AuthorityOf = std::function<ContactAuthority(ObjectId collider, ObjectId collidee, SimTime contact)>;
  struct Authority {
    AuthorityOf of;
    AnsweredAlone alone;
  };
  void set_authority(Authority authority) { authority_ = std::move(authority); }

  // Makes void the laws that were set for the object from t on, and all that followed from them: the object goes on
  // from t as it was set before. For worlds that replay bases; set_base() does it before it sets one.
  void forget_bases(ObjectId object, SimTime t);

  // Sets the object's motion from t on, in the frame of its carrier, after an update, a sample or a decision. t may lie
  // in the past: the predictions that followed from the replaced motion are retracted, and the next advance() finds
  // them anew. What was set for this object from t on is void. With `rest` it rests from t on against its partner,
  // where the pair is watched: at once where the partner answers no contact, else from its own base of t on. With
  // `free` others bear or push the object at t, which has that acceleration where nothing does [m/s^2, world frame]: it
  // rests from then on against what it touches and would run into. Without `model` the object goes on as it moves at t,
  // and only `free` is new, if something bears it then.
  void set_base(ObjectId object, SimTime t, const std::optional<MotionModel>& model,
                const std::optional<Rest>& rest = {}, const std::optional<Vec3>& free = {});

  // Lays the law that this peer publishes of its own object: the same motion, rounded. After a decision that comes late
  // a contact of before t with another own object may still be found; after set_base() it may not.
  void restate(ObjectId object, SimTime t, const MotionModel& model);

  // The acceleration [m/s^2, world frame] that the object has where nothing bears it: from then on, and in
  // whatever motion set_base() gives it. Without it that of the law under which it came to rest counts.
  void set_free_acceleration(ObjectId object, const Vec3& acceleration);
  // Whether others bear or push the object now, so that its acceleration is what they leave of its free one.
  [[nodiscard]] bool is_borne(ObjectId object) const { return objects_[objects_.index_of(object)].borne; }
  // Whether the object bears another one at t, or is borne by it.
  [[nodiscard]] bool presses_another(ObjectId object, SimTime t) const;
  [[nodiscard]] std::optional<Vec3> free_acceleration(ObjectId object) const;

  // The acceleration in the world that the object has at t, or would have if nothing bore it.
  [[nodiscard]] Vec3 unborne_acceleration(ObjectId object, SimTime t) const {
    return objects_.free_acceleration_of(objects_.index_of(object), t);
  }

  // For a caller that sets many objects in turn: fetches from memory what set_base() will need of this one.
  [[gnu::always_inline]] inline void prefetch(ObjectId object) const {
    if (!objects_.contains(object)) return;
    if (const MovingObject* const o = objects_.peek(objects_.index_of(object))) peerd::prefetch(*o);
  }

  // Finds all contacts up to `to`, in time order, and responds to them.
  void advance(SimTime to);
  // Finds anew what a set_base() in the past has made void, until the last advance(): states until then are right
  // again.
  void catch_up() { advance(advanced_); }
  // The latest instant to which the world has been advanced.
  [[nodiscard]] SimTime advanced() const { return advanced_; }

  [[nodiscard]] bool has(ObjectId object) const { return objects_.contains(object); }
  // The objects that may be elsewhere than the file says, and those that somebody has asked for, ascending.
  [[nodiscard]] std::vector<ObjectId> objects() const;
  // The state in the world.
  [[nodiscard]] KinematicState at(ObjectId object, SimTime t) const;
  // The state in the frame of the object's carrier; that in the world where it has none.
  [[nodiscard]] KinematicState relative_at(ObjectId object, SimTime t) const;
  [[nodiscard]] bool is_carried(ObjectId object) const { return objects_[objects_.index_of(object)].carrier != kNone; }
  // A vector of the world in the frame of the object's carrier, as that stands at t; and back.
  [[nodiscard]] Vec3 vector_in_carrier(ObjectId object, SimTime t, const Vec3& world) const;
  [[nodiscard]] Vec3 vector_in_world(ObjectId object, SimTime t, const Vec3& relative) const;
  // The law in force, in the frame of the object's carrier.
  [[nodiscard]] MotionModel model_at(ObjectId object, SimTime t) const;
  // A state in the world as one in the frame of the object's carrier, as that is at t.
  [[nodiscard]] KinematicState in_carrier(ObjectId object, SimTime t, const KinematicState& world) const;
  // Whether the position of the object at t is known: that of more than kHistory before the last advance() is not (see
  // keep_history_of_driven).
  [[nodiscard]] bool has_history_at(ObjectId object, SimTime t) const;
  // The instant at which the law that is in force at t began.
  [[nodiscard]] SimTime law_since(ObjectId object, SimTime t) const;
  // The instant of the last update, sample or decision of the object that stands; predicted pieces do not move it.
  [[nodiscard]] SimTime base_time(ObjectId object) const;
  // Whether the object stands still from t on, by all that this world knows now.
  [[nodiscard]] bool is_at_rest_from(ObjectId object, SimTime t) const;
  // Whether the object stands still in its carrier from t on, by all that this world knows now.
  [[nodiscard]] bool stands_in_carrier_from(ObjectId object, SimTime t) const;
  // Whether the law in force at t is an answer to a contact.
  [[nodiscard]] bool is_moved_by_contact(ObjectId object, SimTime t) const {
    return objects_[objects_.index_of(object)].timeline.segment_at(t).cause.has_value();
  }
  // Calls `function` for the objects whose motion may have changed since the last call, each once and in any order.
  // `function` must not change this world.
  template <class Function>
  void take_changed(Function function) {
    objects_.take_changed(function);
  }
  // A number that changes whenever the future of the object does: by set_base(), or when a response was retracted.
  [[nodiscard]] std::uint64_t revision(ObjectId object) const;
  // Whether two ends of interests touch at t, up to which this world has been advanced, or are nearer than contact
  // times leave them.
  [[nodiscard]] bool ends_touch(ObjectId a, ObjectId b, SimTime t);
  // The events so far, in order; drain after advance().
  using Event = MotionEvent;
  [[nodiscard]] std::optional<Event> poll_event();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[nodiscard]] PairSearch search() { return {*model_, objects_, pairs_, start_, counters_, events_, detection_}; }
  // Makes the WatchedPairs of an interest's pair that may not be far.
  void need_pairs_of(std::uint32_t number);
  // Asks the rule whether the pair is watched.
  void watch_pair(std::uint32_t part_pair);
  // Goes on with the pairs of another model. `change_objects` does so with the objects. Pairs that are new are searched
  // from t on.
  template <class ChangeObjects>
  void replace_model(const WorldModel& next, SimTime t, ChangeObjects change_objects);
  // Returns the pair with the earliest contact of those that are due until then; of several the first in the model's
  // order.
  [[nodiscard]] std::optional<std::size_t> first_contact_until(SimTime to);
  // Called after any change of whether the pair is watched, or of what is known of it.
  void reschedule(std::size_t pair);

  void lay_base(std::size_t object, const Base& base);
  // Takes along all that a driven object bears, and pushes along what it runs into, where its last law led elsewhere at
  // t than where it is now. Returns whether it bore anything.
  bool carry_along(std::size_t object, SimTime t, const KinematicState& before, Duration since);
  // The object rests from then on against its partner, or against what it touches and would run into.
  void begin_rest(std::size_t object, const Base& base);
  // Makes void all that followed from the object's motion from t on.
  void retract_all(std::size_t object, SimTime t);
  // The object's timeline has lost its laws from t on: its bases from then on are to be laid again.
  void retract_bases(const MovingObject& object, SimTime t);
  // Lays the earliest one of those that are to be laid again.
  void lay_next_base();

  void respond_to_contact(WatchedPair& pair);
  void remove_gain(const WatchedPair& pair, SimTime t, const ContactAnswer& answer);
  void report(const WatchedPair& pair, SimTime t, const ContactAnswer& answer);
  // The object moves otherwise from t on, because of a contact with `cause`. The law is in the world; what is carried
  // keeps its state, and goes on in the frame of its carrier.
  // With `in_base` a base of t becomes that law, and stays the base: it is no answer that others retract.
  void change_motion(std::size_t object, SimTime t, const MotionModel& after_in_world, ObjectId cause,
                     bool in_base = false);
  // The two come to rest against each other at t.
  void come_to_rest(WatchedPair& pair, SimTime t);
  // One of the two bears something else: the impulse reaches all that bear each other, in one solution.
  void answer_in_heap(WatchedPair& pair, SimTime t, const ContactAnswer& answer);
  // All that met within the burst are answered at once.
  void answer_squeezed(WatchedPair& pair, SimTime t);
  // The two stand from t on, as far as they respond: there is no room left for any other answer.
  void stop(WatchedPair& pair, SimTime t);
  // An object that is pressed into a wall without end stops there, and the one that presses it goes through it.
  void hold_against_wall(WatchedPair& pair, SimTime t);
  // Gives all that rest on each other around the pair the velocities that their bearing leaves, and
  // `restitution` times that change once more.
  void settle_velocities(WatchedPair& pair, SimTime t, Touching which, double restitution = 0.0);
  // Gives the accelerations that bearing leaves to all that is unsettled at t, and to what it rests on or bears.
  // With `in_bases`, as a base is laid, bases of t get these accelerations and stay bases. Two that bear each other may
  // have bases of one instant, and as answers each would retract the other one's without end.
  void settle(SimTime t, bool in_bases = false);
  // Releases what parts around the object, and holds together what would meet again at once. Returns the island with
  // the accelerations that are left.
  [[nodiscard]] ContactIsland settle_island(std::uint32_t object, SimTime t, bool in_bases);
  // Solves the island, which is of velocities, and gives them to its objects.
  void give_velocities(ContactIsland island, SimTime t, double restitution);
  void set_borne_acceleration(std::size_t object, SimTime t, Vec3 acceleration, std::size_t cause, bool in_base);
  // The two bear each other from t on, or no more.
  void set_bearing(WatchedPair& pair, SimTime t, bool bears);
  // Called once all that the contacts at t change is changed: the two, which met within the burst, go through each
  // other from t on, where there was no room for an answer.
  void let_through(std::uint32_t pair, SimTime t);
  // Leaves a body that rests against another along that normal only the spin about the normal: its corners would press
  // into the other.
  void end_rolling(std::size_t object, SimTime t, const Vec3& normal, std::size_t cause);
  void change_velocity(std::size_t object, SimTime t, const Vec3& velocity, std::size_t cause);
  // All that an object bears that gives way to nothing is unsettled with it.
  void unsettle_borne_by(std::size_t object, SimTime t);
  void lift(WatchedPair& pair, SimTime t);
  [[nodiscard]] bool gives_way(std::size_t object, bool registered, SimTime t) const {
    return objects_[object].will_respond(registered, t);
  }

  // Puts pairs that are far no more back into the schedule.
  void reschedule_opened(const std::optional<NewLaw>& law = {});
  // The lists of answers_to_ as the timelines have them; an entry of one of them.
  void note_answers();
  void note_answer(std::size_t object, std::size_t cause, SimTime t);
  void retract_contacts_of_carried(std::size_t object, SimTime t);
  void retract(std::size_t cause, SimTime t);
  // Retracts the answers of an object to `cause`, or to anything, from t on, and what followed from them.
  void retract_answers(std::size_t object, std::optional<ObjectId> cause, SimTime t);
  // Forgets what the pairs of the object have been through since then: all of it in a world that replays, else the
  // counts of contacts.
  void forget_bursts(std::size_t object, SimTime t);
  // Called before something of t changes what the pair has been through.
  void remember_course(std::uint32_t i, SimTime t);
  // The instant from which the pair is searched again if one of the two moves otherwise from t on; `lived`: this peer
  // moves the other one, or both.
  [[nodiscard]] SimTime reopened_from(std::uint32_t i, bool lived, SimTime t) const;
  // The object's pieces changed from t on. `elsewhere`: also where it is.
  void reopen_pairs(std::size_t object, SimTime t, bool elsewhere);

  static constexpr std::uint32_t kNone = MovingObjects::kNone;

  const WorldModel* model_;
  TickDetection* detection_ = nullptr;
  SimTime start_, advanced_;
  MovingObjects objects_;
  WatchedPairs pairs_;  // without the far ones that have nothing to remember
  KnownPairs known_;    // known_pairs(), once somebody has asked for them
  RememberedCourses courses_;
  FarPairs far_;
  std::vector<std::uint32_t> opened_;  // pairs that are far no more, and not in the schedule yet
  // For each node those of its partners whose timelines have, or had lately, a law with it as the cause; ascending.
  struct Answer {
    std::uint32_t object;
    SimTime last;  // no such law begins later
  };
  std::vector<std::vector<Answer>> answers_to_;
  Schedule pair_checks_;             // by slot of pairs_: when the next check of one that is not far is due
  std::size_t watched_ = 0;          // the number of pairs with a check, whenever that is due
  std::set<std::uint32_t> stopped_;  // into pairs_
  // The pairs that the next advance() is to search again from an instant of the past on, and that instant.
  std::unordered_map<std::uint32_t, SimTime> searched_again_;
  // Settling lists the objects that changed at the instant that is being answered. settle() empties it.
  struct Settling {
    struct Object {
      std::uint32_t object, cause;
    };
    std::vector<Object> objects;  // of which the velocity, or what bears them, has changed
    double fastest = 0.0;         // of the velocities that were solved [m/s]
  };
  Settling settling_;
  bool replays_bases_ = false;
  std::set<std::pair<SimTime, ObjectId>> retracted_bases_;  // bases that are to be laid again
  Authority authority_;
  std::vector<MotionEvent> events_;
  std::size_t polled_ = 0;  // of events_
  Counters counters_;
};

}  // namespace peerd::replication
