#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/math.hpp"
#include "core/scene/scene.hpp"
#include "core/sparse_table.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/response.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// The marks that the contacts of a pair so far have left on it. A world that goes through the past again takes them
// back.
struct PairCourse {
  bool inside = false;                   // a contact without a response goes on (MeetAs::kSolids); reported once
  bool bears = false;                    // the two rest against each other, along all of `normals`
  SimTime parted = SimTime::min();       // when `inside` was last over
  SimTime parted_from = SimTime::min();  // the contact that was over then
  SimTime bore_since = SimTime::max();   // when the two last came to rest against each other
  SimTime bore_until = SimTime::min();   // when the two last bore each other no more
  SimTime touched = SimTime::min();      // of the last contact
  SimTime solved = SimTime::min();       // when laws were last chosen by which the two don't approach
  SimTime lifted = SimTime::min();       // when the two last came apart after they bore each other
  SimTime held_until = SimTime::min();   // the two do not come apart before
  SimTime burst_from = SimTime::min();   // the first contact of the burst
  std::uint32_t at_once = 0;             // contacts until `touched`, each at the instant of the one before
  std::uint32_t in_burst = 0;            // contacts until `touched`, each within kShortestFlight_s of the one before
  std::uint32_t squeezed = 0;            // of the burst: those answered for all that touched
  bool both_changed = false;             // the last contact gave both another motion, and not one alone
  std::vector<Vec3>
      normals{};  // along which the two touch or bear: the last one where its plane parts them, else all of the burst
};

// How a pair stands in the schedule of searches.
struct PairStanding {
  bool watched = false;
  bool is_scheduled = false;  // it is searched when it is due (MotionWorld::reschedule())
  bool is_far = false;        // nobody searches it until one of the two leaves its place (FarPairs)
  bool put_off = false;       // its searches are put off (MotionWorld::put_off())
  bool stopped = false;       // for that reason, at clear_until; it has no contact, and bears nothing
  bool unsupported = false;   // counted once, then never searched again
  bool searched = false;      // some search has been answered
};

// Whether the contacts of a pair of the model are looked for; null: those of all are.
using IsWatched = std::function<bool(const CollisionPair&)>;

// Two parts of two ends of an interest (PartPair). What answers is the end.
struct WatchedPair : PairCourse, PairStanding {
  std::uint32_t collider, collidee;  // the ends, into MovingObjects
  std::uint32_t part_a, part_b;      // the model's parts that meet; kNone: the boxes of both whole ends
  std::uint32_t common;              // the two meet in the frame of that object; kNone: in the world
  std::uint32_t number;              // of the interest's pair, in the model
  CollisionType type;
  bool fixed;
  bool is_plain;  // the parts are the ends, and nothing carries them
  bool is_flexible;
  bool collider_responds, collidee_responds;
  bool has_exact_search;              // collision has an answer
  bool overlapped = false;            // `contact` is an overlap, not a touch
  bool resting = false;               // at `contact` the two are pressed together and do not approach
  bool lifts = false;                 // at `contact` the two come apart: they bore each other until then
  std::optional<bool> fixed_touch{};  // whether the two, which are fixed to each other, touch; none: not known yet
  SimTime clear_until;                // all contacts before this have been dealt with
  std::optional<SimTime> contact;     // the next contact, at clear_until, if the search found one
  std::optional<SimTime> free_at;     // the last instant at which the two were known to be apart: setBack goes there
  Vec3 normal = Vec3::Zero();         // of `contact`
  std::array<std::optional<SimTime>, 3> free_before{};  // earlier values of free_at, the latest first
  // The course before each of the last contacts that changed it, ascending; empty in a world that does not replay.
  struct Past {
    SimTime at;
    PairCourse before;
  };
  std::vector<Past> past{};

  [[nodiscard]] bool is_answered() const { return collider_responds || collidee_responds; }
  // A world that goes through the past again may hold pairs that came to rest later than where it is.
  [[nodiscard]] bool bears_at(SimTime t) const { return bears && bore_since <= t; }
  // The two are known to be apart at t.
  void note_free(SimTime t);
  // Forgets that they were known to be apart at `from` or later.
  void forget_free_since(SimTime from);
  // Whether this pair must be kept, and can't be erased and made anew when it is needed: it has touched at t or later,
  // has a course to go back to, or its searches are off.
  [[nodiscard]] bool remembers_since(SimTime t) const {
    return put_off || !past.empty() || std::max({touched, parted, bore_until, lifted}) >= t;
  }
  // Called before something of t changes the course.
  void remember_course(SimTime t);
  // A world does not go back to before `oldest`.
  void forget_course_before(SimTime oldest);
  // Takes back all that has changed the course at `from` or later.
  void rewind_course(SimTime from);
  // The two touch at t, along `normal`; `is_parted`: the plane with that normal lies between the two.
  void note_touch(SimTime t, bool is_parted);
  void begin_to_bear(SimTime t) {
    if (!bears_at(t)) bore_since = t;
    bears = true;
  }
};

// Two that part for a shorter time stay together.
inline constexpr Duration kShortestFlight{static_cast<std::int64_t>(kShortestFlight_s * 1e9)};

// Two that bore each other, and slowly meet again within that time, have one contact that lasts.
inline constexpr Duration kSameContact{std::int64_t{1} << 26};

[[nodiscard]] inline bool met_lately(SimTime met, SimTime t, Duration within) { return met <= t && t <= met + within; }

// The model's part pairs that are near, and the far ones that have something to remember (FarPairs): all of an
// interest, or none. The numbers are those of the model.
class WatchedPairs {
 public:
  explicit WatchedPairs(const WorldModel& model) : pairs_(model.part_pairs.size()), of_end_(model.nodes.size()) {}

  [[nodiscard]] std::size_t size() const { return pairs_.size(); }
  [[nodiscard]] bool contains(std::size_t number) const { return pairs_.contains(number); }
  [[nodiscard]] WatchedPair* find(std::size_t number) { return pairs_.find(number); }
  [[nodiscard]] const WatchedPair* find(std::size_t number) const { return pairs_.find(number); }
  [[nodiscard]] WatchedPair& operator[](std::size_t number) { return pairs_[number]; }
  [[nodiscard]] const WatchedPair& operator[](std::size_t number) const { return pairs_[number]; }
  [[nodiscard]] std::span<const std::uint32_t> numbers() const { return pairs_.numbers(); }  // in any order
  // The pairs of which the node is an end, ascending.
  [[nodiscard]] std::span<const std::uint32_t> of_end(std::size_t node) const {
    if (node >= of_end_.size()) return {};
    return of_end_[node];
  }
  // The slots of pairs (SparseTable).
  [[nodiscard]] std::size_t slots() const { return pairs_.slots(); }
  [[nodiscard]] std::size_t slot_of(std::size_t number) const { return pairs_.slot_of(number); }
  [[nodiscard]] std::uint32_t number_in(std::size_t slot) const { return pairs_.number_in(slot); }

  WatchedPair& add(std::uint32_t number, WatchedPair pair);
  void erase(std::uint32_t number);

 private:
  SparseTable<WatchedPair> pairs_;
  std::vector<std::vector<std::uint32_t>> of_end_;
};

struct RememberedCourses {
  std::set<std::uint32_t> pairs;       // those of which a course is remembered
  SimTime forgotten = SimTime::min();  // when courses were last forgotten
};

// Begins with the part pairs of an interest, of which none is there: nothing is known of them from `start` on.
void add_pairs(WatchedPairs& pairs, const WorldModel& model, std::uint32_t interest, SimTime start, bool watched);
// Gives the pairs of `next` what is known of those of `before`, where their interest, their two parts and who answers
// are the same. Then it adds, and returns in ascending order, the watched pairs whose interest is new or of which a
// part has changed. Such a pair is `inside` if another pair of its two ends was. A pair that was far and has not
// changed gets no WatchedPair.
std::vector<std::uint32_t> carry_over(const WorldModel& before, WatchedPairs known, const WorldModel& next,
                                      SimTime start, const IsWatched& is_watched, WatchedPairs& pairs);

}  // namespace peerd::replication
