#pragma once
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "peerd/input/world_file.hpp"

namespace peerd {

// The code that run_collide() returns where CollideOptions::interrupted has ended it: 128 + SIGINT, as shells have it.
inline constexpr int kInterrupted = 130;

// `peerd collide WORLD.wrl` answers all registered interests, once, or tick by tick. Problems of the world go to `err`
// as `peerd check` prints them. Returns the exit code: 0 good, colliding or not; 1 the world has errors, or a Shape
// whose vertices can't be used; 2 there is no such file, or no tick at the times asked for; 3 it can't be read; 130 it
// was interrupted.
//
// With `json` it prints one object to `out`, which is that of error_json where there is no answer:
//   world      path as it was given
//   time_s     time of the query
//   interests  [{collider, collidee, type, colliding, pairs}], one for each collidee of each CollisionInterest, in file
//              order. `type` is box, witness or allpairs; `pairs` is [{a: [SHAPE, POLYGON], b: [SHAPE, POLYGON]}], a of
//              the collider and b of the collidee: none for a box, one for a witness, for allpairs all, sorted by the
//              Shapes' places in the file. A path is DEF names, or child indices where there is none, joined by '/'.
//   counters   hierarchies_built, nodes_built, bv_tests, polygon_tests (of triangles of polygons), exact_tests
//   micros     wall-clock time from the world as read to the answers
//
// With `until_s` it goes tick by tick from `at_s` on, as the world's own motion does, and reports which collisions
// begin and which end, a line for each event, or one object:
//   world, time_s   as above
//   until_s, hz     end, and ticks a second: tick k is at time_s + k / hz, as long as that is no later
//   ticks           number of ticks
//   tick_micros     {ticks, mean, median, greatest}: wall-clock time of the ticks at which a pair of objects was asked,
//                   with what these ticks built; all 0 where there is none
//   events          [{time_s, event: "began"|"ended", collider, collidee, type}] of interests, and
//                   [{time_s, event: "notColliding", object, value}] of Transforms, the eventOut of that name; by time,
//                   those that ended first, then those that began, in file order, then Transforms in file order. A
//                   collision at the start begins there.
//   counters        the counters above; box_tests (of the broad phase); pairs_postponed, pairs_far, pairs_unmoved,
//                   pairs_separated (pairs of objects passed over: they could not touch yet; their boxes are apart;
//                   neither moved; neither has gone as far as they were apart), pairs_asked, pairs_witnessed (of
//                   Shapes: still touching where they did), pairs_tested
//   micros          as above; evaluating the motion counts, too
//   engine          the words of another engine than ours, where one was chosen; also without `until_s`
//   against         with `against`, also without `until_s`: {engine, questions, false_touches, missed, interests:
//                   [{collider, collidee, type, questions, false_touches, missed}]}. A question is an interest at a
//                   tick; its answer is wrong where it says colliding and the other engine does not, or the other way
//                   round. With `until_s` `micros` has the other engine's time in it.
//   warnings        [sentence]: what the movement leaves out
//   partial         only if interrupted: true. `ticks` says how far it has come
struct CollideOptions {
  WorldReading reading{};
  bool json = false;
  double at_s = 0.0;  // TimeSensor time [s]; velocityVectors have moved their objects since 0
  std::optional<double> until_s{};
  double hz = 60.0;
  std::function<bool()> interrupted{};   // asked before each tick: whether to stop with what there is; none: never
  std::ostream* progress = nullptr;      // a terminal that shows how far it has come; null: none
  bool realigned_boxes = false;          // type box by the thesis's larger boxes: collision::BoxBound
  std::string engine = "ours";           // collision::engines::make_engine(); another one is named in the answer
  std::optional<std::string> against{};  // an engine whose answers are taken to be right; none: no comparison
};
// `peerd collide --engines` prints the engines that there are; with `json` [{name, exact, reference, about}].
[[nodiscard]] int list_engines(bool json, std::ostream& out);

[[nodiscard]] int run_collide(const std::string& path, const CollideOptions& options, std::ostream& out,
                              std::ostream& err);

}  // namespace peerd
