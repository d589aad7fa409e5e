#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "collision/contact/contact_time.hpp"
#include "core/box.hpp"
#include "peerd/lab/measure/run_record.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd {

// Measures how far objects are in each other and what energy they have, from their states at one instant after the
// other. A pair costs something while one of its two moves and their bounding volumes overlap.
//
// The pairs are those of interests that one of the two answers. Left out and counted are pairs with what the world
// itself moves, with what consists of several bodies that move in each other or changes its shape, and those without an
// exact answer. The world is that of the file: what edits make of it is not followed.
class ContactMeter {
 public:
  ContactMeter(const config::RunSettings& run, const SharedWorld& shared,
               std::span<const config::PeerObjects> resolved);

  struct Seen {
    ObjectId object;
    KinematicState state;
    bool is_own = false;  // of a view: the observer owns it
  };
  // The states that the owners have at an instant.
  void see_truth(double t_s, std::span<const Seen> seen);
  // The states that an observer has at an instant.
  void see_view(double t_s, PeerId observer, std::span<const Seen> seen);

  [[nodiscard]] measure::ContactsMeasured result(std::span<const measure::ContactRow> contacts,
                                                 double duration_s) const;

 private:
  // The other end of a pair: an object, or what stands.
  struct Candidate {
    std::uint32_t index;
    bool stands;
    CollisionType type;
  };
  struct Object {
    ObjectId id;
    PeerId owner;
    bool is_driven = false;
    const collision::Body* body = nullptr;  // null: no pair of it is measured
    std::vector<Candidate> candidates;      // but for what it may meet as one of a crowd
    double threshold_m = 0.0;
    double mass_kg = 0.0;       // 0: its energy does not count
    Vec3 drive = Vec3::Zero();  // [m/s^2]
    bool was_seen = false;
    Vec3 first_place = Vec3::Zero(), stands_at = Vec3::Zero();  // of the truth
    double stands_since_s = 0.0;                                // near `stands_at`
  };
  struct Standing {
    ObjectId object;
    const collision::Body* body;
    KinematicState state;
    WorldBox box;
    std::string path;
  };
  // The members of a group whose pairs are not listed.
  struct Crowd {
    const replication::PairGroup* group;
    std::vector<std::uint32_t> objects, standing;  // indices
  };
  struct Place {
    KinematicState state;
    Vec3 velocity_before = Vec3::Zero();  // at the instant before [m/s]
    Vec3 center = Vec3::Zero();           // of the body's sphere, in the world [m]
    std::uint32_t seen = 0, moved = 0;    // the numbers of the last instants
    bool is_own = false;
  };
  struct View {
    std::vector<Place> places;  // by object
    std::uint32_t instant = 0;
  };
  struct End {
    const Object& object;  // of what stands: the other one
    const collision::Body& body;
    const KinematicState& state;
    const Vec3& velocity_before;
    const std::string* path = nullptr;  // of what stands
  };

  void find_pairs();
  // Whether the states of the end are known: it is an object, or stands.
  [[nodiscard]] bool is_measured(const replication::ModelNode& node) const;
  // Whether an end of the pair answers it, and its answers are none that somebody gives from outside.
  [[nodiscard]] bool is_answered(const replication::CollisionPair& pair) const;
  [[nodiscard]] const Object* object_of(ObjectId id) const;  // null where nobody owns it
  [[nodiscard]] std::uint32_t standing_of(ObjectId id);
  void add_crowd(const replication::PairGroup& group);
  void place(View& view, std::span<const Seen> seen);
  void find_overlaps(double t_s, const View& view, std::optional<PeerId> observer);
  void find_overlaps_of_crowds(double t_s, const View& view, std::optional<PeerId> observer);
  // Each two of the crowd of which one has moved and whose spheres along x overlap: `function` gets their indices.
  template <class Function>
  void for_each_near(const Crowd& crowd, const View& view, Function function) const;
  void note_standing(double t_s, const Object& object, const Place& place, const Standing& wall, CollisionType type,
                     std::optional<PeerId> observer);
  void note_met(double t_s, const View& view, std::uint32_t a, std::uint32_t b, CollisionType type,
                std::optional<PeerId> observer);
  void note(double t_s, const End& a, const End& b, CollisionType type, std::optional<PeerId> observer);
  void add_energy();

  const Scene& scene_;
  const replication::WorldModel& model_;
  std::vector<Object> objects_;                           // by id
  std::unordered_map<ObjectId, std::uint32_t> index_of_;  // for look-ups alone, in objects_
  std::vector<Standing> standing_;
  std::map<ObjectId, std::uint32_t> index_of_standing_;
  std::vector<Crowd> crowds_;
  View truth_;
  std::map<PeerId, View> views_;
  std::map<PeerId, std::string> names_;
  double delay_s_;  // the longest of any link, and a tick
  measure::ContactsMeasured measured_;
};

}  // namespace peerd
