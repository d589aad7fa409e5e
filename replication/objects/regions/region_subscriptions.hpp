#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/grid/interest.hpp"
#include "replication/settings/grid/region_grid.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/output/tick_grid.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Manages the regions where the scene is cut into them: the regions that this peer subscribes to, by what matters to
// it; the remote objects that it therefore receives; and the handovers of own objects from region to region.
class RegionSubscriptions {
 public:
  // Called after this peer has begun or ceased to receive an object.
  using OnReceptionChanged = std::function<void(ObjectId object, bool received)>;

  // All arguments outlive this object.
  RegionSubscriptions(const PeerConfig& config, const ModelInForce& model, Membership& members, const Owners& owners,
                      OwnObjects& own, Replica& replica, const TickGrid& ticks, Outbox& outbox, PeerCounters& counters,
                      OnReceptionChanged on_reception_changed);

  [[nodiscard]] const RegionGrid& grid() const { return grid_; }
  [[nodiscard]] const Interest& interest() const { return interest_; }
  [[nodiscard]] bool cuts() const { return grid_.cuts(); }

  // ---- the regions that this peer listens to

  // At a tick: joins and leaves regions, asks for the states in joined ones. `now`: session time of this call.
  void follow_interest(SimTime t, SimTime now);
  // Returns at most so many subscriptions that are due, and counts them as sent. `goes_anyway`: in a datagram that
  // goes anyway; otherwise none are taken before one of them must go.
  [[nodiscard]] std::vector<Subscription> take(std::size_t most, bool goes_anyway);
  // Sends what is due in datagrams of its own, to all peers: the owner of objects in a region need not listen to it.
  void announce();

  // Sends a message for all: to all, or, in a large session, to the regions where this peer publishes its objects,
  // those whose states the message asks for, and those of the objects of its decisions. What has none of these regions
  // goes to those where this peer listens, and so do the hellos of a peer that owns nothing. Returns the message's
  // number; none: it listens nowhere, and nothing goes out.
  std::optional<std::uint32_t> send_to_peers(Message& message, std::span<const EncodedUpdate> updates = {});

  // ---- the objects that this peer receives

  // Whether the object's owner publishes it where this peer listens, as far as that is known.
  [[nodiscard]] bool is_heard(ObjectId object) const {
    const auto last = last_receptions_.find(object);
    return last != last_receptions_.end() && interest_.joined(last->second.region) && replica_.receives(object);
  }

  // Another peer owns the object now. Nobody here knows where the object is.
  void on_claimed(ObjectId object, SimTime last_tick);
  // An update of a remote object: false where it says that the object is in a region that this peer does not listen to.
  [[nodiscard]] bool accept(const UpdateRecord& update, SimTime session_now);
  void on_handovers(PeerId sender, std::span<const Handover> handovers, SimTime session_now);
  // The object has lost its owner and stays where it is: a peer that leaves its region keeps it.
  void on_orphaned(ObjectId object) { last_receptions_.erase(object); }
  // Nobody owns the scene object any more, or this peer does: every peer knows where it is.
  void on_known_everywhere(ObjectId object);
  // Session time has stepped: everything is published anew, and remote objects may be anywhere.
  void restart_at(SimTime now);

  // ---- the regions in which own objects are published

  // Another peer subscribes: the next tick publishes anew what it may not have.
  void on_subscriptions(PeerId sender, std::span<const Subscription> subscriptions, SimTime session_now);
  // Whether `position` is farther from the cell in which the object was published last than others grow their areas.
  [[nodiscard]] bool has_left_region(const OwnObject& own, const Vec3& position) const;
  // The object has been published there. `receiver_may_hold_nothing`: a receiver may know nothing of it but by this.
  void on_published(OwnObject& own, const UpdateRecord& update, bool receiver_may_hold_nothing);
  // The handovers that are due, by the regions that they go to, and counts them as sent. `goes_anyway`: whether a
  // datagram goes to that region anyway.
  using GoesAnyway = std::function<bool(RegionId)>;
  [[nodiscard]] std::map<RegionId, std::vector<Handover>> take_handovers(const GoesAnyway& goes_anyway);
  // The model in force is of an edited scene.
  void follow_model();
  // Another peer owns the object now: there is nothing to hand over.
  void forget_handovers_of(ObjectId object);
  // The region in which the object was published last, kWholeScene where that is not known.
  [[nodiscard]] RegionId region_of(ObjectId object) const;
  // Notes which parts that own objects move may meet what remote objects move, by these pairs; `anew`: by these alone,
  // else also by those of earlier calls.
  void measure_contact_ranges(const PairNumbers& pairs, bool anew);
  // The areas around those parts at t, in which the remote objects are that may touch them then, or within that time
  // [s]: objects are published where their origins are, however far away from there they have parts.
  [[nodiscard]] std::vector<Area> contact_areas(SimTime t, double within_s) const;

 private:
  [[nodiscard]] std::vector<RegionId> regions_for(const Message& message) const;
  struct LastReception {
    RegionId region;
    SimTime at{};  // when this peer received it
    // When this peer asked whether the object is still there, for want of an update.
    std::optional<SimTime> requested_at{};
  };
  // An announcement goes out in copies, a tick apart, and is then repeated some time apart.
  struct Announcement {
    std::uint32_t copies;   // copies still to be sent
    std::uint32_t repeats;  // repetitions after the copies
    std::optional<SimTime> sent_at{};

    [[nodiscard]] bool is_due(SimTime t, Duration apart) const;
    [[nodiscard]] bool is_over() const { return copies + repeats == 0; }
    void note_sent(SimTime t);
  };
  struct PendingSubscription : Announcement {
    Subscription subscription;
  };
  struct PendingHandover : Announcement {
    Handover handover;
    RegionId from;
  };

  // A part that own objects move, or the box of a whole end of such; and the parts, or whole ends, that it may meet,
  // with each remote object that moves them.
  struct Reach {
    std::uint32_t part = ModelNode::kNone;  // kNone: the whole end
    ObjectId end{};                         // in that case
    friend auto operator<=>(const Reach&, const Reach&) = default;
  };
  struct Partners {
    double fixed_m = 0.0;                              // how far rigid parts reach from what moves them, at most
    std::set<std::pair<std::uint32_t, Reach>> moving;  // nodes of remote objects, and other parts
  };
  // A frame, and how far from its origin something reaches [m].
  struct Reached {
    KinematicState frame;
    double extent_m = 0.0;
  };

  void forget_ranges_of_others();
  void note_contact_range(const PartPair& parts, bool of_collider);
  [[nodiscard]] bool is_anothers(ObjectId object) const;
  void note_partners(Partners& partners, const Reach& partner, std::uint32_t common) const;
  [[nodiscard]] std::vector<std::uint32_t> chain_of(const Reach& reach, std::uint32_t common) const;
  [[nodiscard]] Reached reached(const MotionWorld& world, const Reach& reach, SimTime t, double within_s) const;
  void add_carriers(SimTime t, double within_s, std::vector<Area>& areas) const;
  [[nodiscard]] Duration state_request_takes() const;
  [[nodiscard]] std::optional<std::vector<Area>> areas(SimTime t) const;
  void join(RegionId region, SimTime now);
  void leave(RegionId region, SimTime t);
  void request_states_of(RegionId region, SimTime now);
  void expire_silent_objects(SimTime t, SimTime now);
  void stop_receiving(ObjectId object);
  void leave_interest(ObjectId object, SimTime t);
  [[nodiscard]] std::size_t pairs_with_received(ObjectId object) const;
  void announce_handover(const UpdateRecord& update, RegionId from, RegionId to);
  void drop(PeerId sender, const char* reason);

  const PeerConfig& config_;
  const ModelInForce& model_;
  Membership& members_;
  const Owners& owners_;
  OwnObjects& own_;
  Replica& replica_;
  const TickGrid& ticks_;
  Outbox& outbox_;
  PeerCounters& counters_;
  OnReceptionChanged on_reception_changed_;
  RegionGrid grid_;
  Interest interest_;
  std::map<Reach, Partners> contact_ranges_;
  double remote_radius_m_ = 0.0;  // the largest bounding radius of what other peers have ever owned
  std::map<ObjectId, LastReception> last_receptions_;  // the last receptions of remote objects that this peer receives
  std::size_t unreceived_pairs_ = 0;                   // the number of pairs of the objects that it does not receive
  std::vector<PendingSubscription> pending_subscriptions_;
  std::vector<PendingHandover> pending_handovers_;  // of own objects, in no region that they are published in
};

}  // namespace peerd::replication
