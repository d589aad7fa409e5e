#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <boost/container/flat_map.hpp>
#include <boost/container/flat_set.hpp>
#include <boost/container/small_vector.hpp>

#include "core/ids.hpp"
#include "core/object_table.hpp"
#include "core/scene/scene.hpp"
#include "core/schedule.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/model_choice.hpp"
#include "replication/physics/laws/position_history.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/settings/policy/budget.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A small set of peers, side by side in memory, for it is read for every own object.
using FewPeers = boost::container::flat_set<PeerId, std::less<>, boost::container::small_vector<PeerId, 4>>;

// The last update of an own object on its way to the others.
struct Delivery {
  std::optional<UpdateRecord> record;  // what is repeated; none: nothing
  bool copying = false;                // the object waits for its copies (Publication)
  std::uint32_t times_sent = 0;        // aside from the repetitions with hellos
  std::uint32_t times_with_hello = 0;
  HostTime with_hello_at{};            // the last time with a hello
  std::vector<std::uint32_t> sent_in;  // the numbers of the datagrams that carried it to all
  FewPeers acknowledged_by;            // the peers that are known to have one of those
  FewPeers unacknowledged_by;        // the peers that have not confirmed the update before it, although there was time
  bool copy_until_received = false;  // a receiver may know nothing of the object but by this update
};

// A change that an owner has made to an object that physics moves: a launch, a key or a throw. Velocities are in the
// frame of the object's carrier [m/s].
struct VelocityChange {
  static constexpr std::size_t kKept = 8;  // of an object

  SimTime at;
  Vec3 before, after;
  bool replaces = true;  // the velocity becomes `after`; else the difference is added
};

// An object that this peer owns, and the state of its publication.
struct OwnObject {
  bool driven = false;   // samples move it; else physics does
  bool adopted = false;  // a scene object that a decision has given to this peer until it rests
  Launch launch;
  std::vector<VelocityChange> velocity_changes;  // the last ones, in order of time
  std::optional<SimTime> driven_since;           // when it got the acceleration that it has where nothing bears it
  // The error threshold [m] at the last check; none: there has been no check yet.
  std::optional<double> threshold_m;
  double bounding_radius_m = 0.0;  // of its farthest vertex from its origin, where errors count by its surface; else 0
  std::optional<SimTime> last_sent;
  std::uint32_t sequence = 0;  // of its last update
  bool resend = false;         // a peer has joined, or may not have the last update
  bool republish = false;      // the last update was not true
  Delivery delivery;
  std::optional<ModelChooser> models;
  PoseHistory poses;  // of samples without derivatives
  UpdateBudget budget;
  double interval_s = 0.25;                // between its last updates, smoothed
  std::optional<Vec3> published_position;  // by its last update [m, world]
};

// The objects that this peer owns, ascending, and the ticks at which each must be checked for an update.
class OwnObjects {
 public:
  using Map = boost::container::flat_map<ObjectId, OwnObject>;

  // `objects` in any order. The model outlives this. `surface_error`: errors count by how far an object's surface is
  // off.
  OwnObjects(const ModelInForce& model, std::span<const OwnedObject> objects, bool surface_error);

  [[nodiscard]] bool contains(ObjectId object) const { return index_.of(object) != kNoIndex; }
  [[nodiscard]] OwnObject* find(ObjectId object) {
    const std::uint32_t index = index_.of(object);
    return index == kNoIndex ? nullptr : &map_.nth(index)->second;
  }
  [[nodiscard]] const OwnObject* find(ObjectId object) const {
    const std::uint32_t index = index_.of(object);
    return index == kNoIndex ? nullptr : &map_.nth(index)->second;
  }
  [[nodiscard]] OwnObject& at(ObjectId object) { return map_.at(object); }
  [[nodiscard]] const OwnObject& at(ObjectId object) const { return map_.at(object); }
  [[nodiscard]] std::size_t size() const { return map_.size(); }
  [[nodiscard]] Map& map() { return map_; }
  [[nodiscard]] const Map& map() const { return map_; }
  [[nodiscard]] Map::iterator begin() { return map_.begin(); }
  [[nodiscard]] Map::iterator end() { return map_.end(); }
  [[nodiscard]] Map::const_iterator begin() const { return map_.begin(); }
  [[nodiscard]] Map::const_iterator end() const { return map_.end(); }

  // This peer owns these, too, from now on; in any order.
  void add(std::span<const OwnedObject> objects);
  // A decision gives this peer a scene object.
  void adopt(ObjectId object);
  // Other peers own these from now on: they are no longer here. Objects that are not are left out. If one comes back,
  // its updates are numbered on.
  void remove(std::span<const ObjectId> objects);
  // The model in force is of an edited scene, which has all of these objects.
  void follow_model();

  // The index of the first object, from `index` on, that a tick at t has to check; size() where there is none.
  [[nodiscard]] std::size_t next_to_check(std::size_t index, SimTime t) const { return checks_.next_due(index, t); }
  // A tick need not check the object before t.
  void check_from(std::size_t index, SimTime t) { checks_.set(index, t); }
  // The next tick checks the object, or all of them. Objects that are not here are left out.
  void check(ObjectId object);
  void check_all();
  // The last update of the object was not true: the next tick publishes it anew. Objects that are not here are left
  // out.
  void republish(ObjectId object);
  // A peer may not have the last updates: the next tick sends them again.
  void resend_all();
  // A peer has gone.
  void forget_acknowledgements_of(PeerId peer);

 private:
  static constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();
  OwnObject& begin(ObjectId object);
  void build_index();

  const ModelInForce& model_;
  const bool surface_error_;
  Map map_;
  std::map<ObjectId, std::uint32_t> sequences_;  // the last ones of objects that are no longer here
  Schedule checks_;                              // by the objects' indices in map_
  ObjectTable<std::uint32_t> index_{kNoIndex};   // into map_ and checks_
};

}  // namespace peerd::replication
