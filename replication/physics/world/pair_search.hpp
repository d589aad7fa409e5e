#pragma once
#include <vector>

#include "replication/physics/world/motion_event.hpp"
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/part_contact.hpp"
#include "replication/physics/world/watched_pair.hpp"

namespace peerd::replication {

// While two objects are inside each other and move apart, the next check is after this long. The step is fixed and not
// the tick, so that peers with other tick rates find the same.
inline constexpr Duration kOverlapRetry = std::chrono::milliseconds(10);

// The law that an object has had since a moment ago.
struct NewLaw {
  std::size_t object;
  SimTime from;
};

// The search for the next contact of a pair, by the timelines as they are now: a view of a MotionWorld's data, which
// outlives it. What is found stays in the pair.
class PairSearch {
 public:
  PairSearch(const WorldModel& model, MovingObjects& objects, WatchedPairs& pairs, SimTime start,
             MotionCounters& counters, std::vector<MotionEvent>& events, TickDetection* detection = nullptr)
      : model_(model),
        objects_(objects),
        pairs_(pairs),
        start_(start),
        counters_(counters),
        events_(events),
        detection_(detection) {}

  // Searches until a contact is found, the pair is known to have none until `to`, or it stops as it is put off. Returns
  // the instant for which the bounds of the two are apart, if the last window was one in which they are.
  std::optional<SimTime> search(WatchedPair& pair, SimTime to);
  // The two, which were far, were apart at all instants before pair.clear_until; the law may be the reason that they
  // are far no more. They are searched again from `reopened` on.
  void note_was_far(WatchedPair& pair, const std::optional<NewLaw>& law, SimTime reopened);
  // Whether the plane of that normal, facing the collider, has the collider on its one side and the collidee on the
  // other at t.
  [[nodiscard]] bool is_parted_by(const WatchedPair& pair, const Vec3& normal, SimTime t) const;
  // The two touch at t along pair.normal. They keep the normals along which they touched before, unless the plane of
  // this one lies between the two.
  void note_touch(WatchedPair& pair, SimTime t) const;
  [[nodiscard]] bool touch_at(const WatchedPair& pair, SimTime t) const;
  // The normal in the world, facing the collider, along which the two would meet within that time, as they move at t
  // and where they touch then. None: they do not touch, or would not meet.
  [[nodiscard]] std::optional<Vec3> normal_of_meeting(const WatchedPair& pair, SimTime t, Duration within) const;
  // Whether the two, which are fixed to each other, touch.
  [[nodiscard]] bool fixed_parts_touch(WatchedPair& pair, SimTime t) const;
  // Whether another part of the one end touches another part of the other one: then the two ends did so before t.
  [[nodiscard]] bool ends_touch_elsewhere(const WatchedPair& pair, SimTime t);

 private:
  [[nodiscard]] SweptBound bound_of_side(const WatchedPair& pair, bool of_collider, SimTime s);
  template <class Function>
  [[nodiscard]] auto with_query(const WatchedPair& pair, Function function) const;
  // Searches the time in which both objects keep their pieces, or until the next multiple of kLookahead. Returns
  // whether their bounds are apart all that time, and nothing bears the one by the other.
  bool search_window(WatchedPair& pair);
  bool search_window(WatchedPair& pair, const SweptBound& bound_a, const SweptBound& bound_b);
  bool search_composed_window(WatchedPair& pair);
  // Searches for the first contact from `begin` on; contacts before pair.clear_until have been dealt with.
  void search_interval(WatchedPair& pair, SimTime begin, SimTime end);
  [[nodiscard]] bool goes_on(WatchedPair& pair, SimTime s, SimTime end);
  // Whether nothing but parting can end the contact from s on: the two bear each other, do not turn, go on by the laws
  // for which that was solved, and have a plane between them that they do not approach.
  [[nodiscard]] bool glides(const WatchedPair& pair, const SweptBound& a, const SweptBound& b, SimTime s) const;
  // Whether one of the two responds by IMPULSE.
  [[nodiscard]] bool answers_by_impulse(const WatchedPair& pair) const;
  // Whether the two are apart at s, from which on a search has found nothing.
  [[nodiscard]] bool was_apart(const WatchedPair& pair, SimTime s) const;
  // The two are known to be apart at s.
  void note_apart(WatchedPair& pair, SimTime s);
  // The two bear each other and move: whether, and when, they come apart until `end`.
  void search_lift(WatchedPair& pair, SimTime begin, SimTime end);

  const WorldModel& model_;
  MovingObjects& objects_;
  WatchedPairs& pairs_;
  SimTime start_;
  MotionCounters& counters_;
  std::vector<MotionEvent>& events_;
  TickDetection* detection_;  // none: contact times
};

}  // namespace peerd::replication
