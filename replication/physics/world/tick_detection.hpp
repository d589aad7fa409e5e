#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "collision/scene/narrow_phase.hpp"
#include "replication/physics/world/part_query.hpp"

namespace peerd::replication {

// Contacts as the implementation of the thesis has them (Ohlenburg 2003, 3.3): another engine (collision/engines) is
// asked at each tick whether two parts touch as they stand then. A contact is at the first tick at which they touch:
// never earlier than the true contact, by less than a tick later, and one that begins and ends between two ticks is
// missed. The parts are in each other by then. The normal is that of the collidee's polygon in the first pair that
// touches and that the collider, by the velocities of the two, comes towards; parts that answer each other and come
// towards none are on their way out. Nothing else keeps what rests on a floor from sinking into it.
//
// Ticks are those of session time, `hz` a second, as TickGrid has them; what is found at a tick holds until the next.
// So peers with the same engine and rate find the same contacts, however they are asked. Whole ends by their boxes
// (kBox), flexible parts and parts without polygons are searched as ever.
//
// Not thread-safe: each peer has its own.
class TickDetection {
 public:
  TickDetection(std::unique_ptr<collision::NarrowPhase> engine, std::uint32_t hz);

  [[nodiscard]] static bool answers(const PartQuery& query);
  // The first contact at a tick in [from, until). `searches` counts questions to the engine.
  [[nodiscard]] PartContact first_contact(const PartQuery& query, SimTime from, SimTime until, std::uint64_t& searches);
  // Whether the two touch at the last tick until t.
  [[nodiscard]] bool touch(const PartQuery& query, SimTime t);
  [[nodiscard]] SimTime next_tick_after(SimTime t) const;

 private:
  [[nodiscard]] SimTime last_tick_until(SimTime t) const;
  [[nodiscard]] std::vector<collision::PolygonPair> pairs(const PartQuery& query, const KinematicState& a,
                                                          const KinematicState& b);
  [[nodiscard]] collision::NumberedSoup numbered(const std::shared_ptr<collision::Surface>& surface);

  std::unique_ptr<collision::NarrowPhase> engine_;
  std::int64_t hz_;
  std::uint64_t last_number_ = 0;
  // The numbers of soups. The bodies of edited scenes go; as long as an entry is here no other surface is taken for it.
  std::map<std::weak_ptr<collision::Surface>, std::uint64_t, std::owner_less<>> numbers_;
};

}  // namespace peerd::replication
