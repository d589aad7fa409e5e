#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/contacts/contact_decisions.hpp"
#include "replication/objects/regions/region_subscriptions.hpp"
#include "replication/objects/replica/launches.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/own_sample.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/updates/proximity_threshold.hpp"
#include "replication/objects/updates/update_repeater.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/output/tick_grid.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::replication {

// Chooses the updates of own objects that go out, and when: those whose ghosts have gone too far from the truth, those
// whose time is up, and those that fit beside them.
class Publication {
 public:
  // All arguments outlive this object.
  Publication(const PeerConfig& config, const ModelInForce& model, const Membership& members, const Owners& owners,
              OwnObjects& own, Launches& launches, Replica& replica, RegionSubscriptions& regions,
              ContactDecisions& decisions, const TickGrid& ticks, Outbox& outbox, PeerCounters& counters);

  // At the tick at t: sets the truth of driven objects. Ignores samples of objects that this peer no longer owns.
  void take(SimTime t, std::span<const OwnSample> samples);
  // The tick at t, after both worlds have been advanced to it: makes the updates that are due.
  void publish(SimTime t);
  // Whether the sample, between two ticks at t, is so far from the prediction of the receivers that its object may not
  // wait.
  [[nodiscard]] bool is_urgent(const OwnSample& sample, SimTime t) const;
  // Makes the updates of changes that no receiver could predict, and those of the samples that are due. The caller
  // calls it between two ticks, after both worlds have been advanced to t.
  void publish_at_once(SimTime t, std::span<const OwnSample* const> samples);
  // The caller calls it with each hello: it sends again the updates that nothing newer has replaced and that a peer may
  // not have.
  void repeat_updates(HostTime now, SimTime session_now);
  // A relay passes on another peer's update.
  void relay(const UpdateRecord& update) { updates_due_.emplace_back(update, update.at); }
  // Sends what is due in as few datagrams as hold it. `with_decisions`: copies of decisions and handovers, too.
  void flush(bool with_decisions);
  // Two objects have met in the ghosts, at the tick of time t or before. Where they are published in different regions,
  // both are published anew: a peer that receives one of them must receive the outcome. Where an own driven object
  // passed the other in truth, it is published as it was just before the contact: all peers take that contact back.
  void on_predicted_contact(const ContactEvent& contact, SimTime t);
  // Session time has stepped: the updates that wait are void.
  void restart();

 private:
  // An own object that a tick has checked.
  struct Checked {
    ObjectId object;
    OwnObject* own;
    GhostError error;
    double threshold_m;
  };
  // An object of which an update is due, where bytes are counted.
  struct Due {
    Checked what;
    PublishReason reason;
    double urgency = 0.0;
  };

  void observe(ObjectId object, OwnObject& own, SimTime t, double latency_s);
  [[nodiscard]] bool is_worth_an_update(OwnObject& own, SimTime t, const GhostError& error) const;
  void publish_changed(SimTime t);
  void publish_most_urgent(SimTime t);
  void publish_piggybacked(SimTime t);
  [[nodiscard]] bool tracks_acknowledgements() const;
  [[nodiscard]] bool update_is_redundant(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                                         const KinematicState& ghost, const GhostError& error) const;
  [[nodiscard]] bool bears_another(ObjectId object, SimTime t) const;
  [[nodiscard]] bool has_found_none(ObjectId a, ObjectId b, SimTime since) const;
  [[nodiscard]] bool is_support_elsewhere(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                                          const GhostError& error) const;
  [[nodiscard]] std::optional<PublishReason> why_due(ObjectId object, OwnObject& own, SimTime t, double threshold_m,
                                                     const KinematicState& truth, const KinematicState& ghost,
                                                     const GhostError& error) const;
  [[nodiscard]] SimTime next_check(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                                   const GhostError& error) const;
  [[nodiscard]] bool published_since_tick(const OwnObject& own) const;
  [[nodiscard]] std::optional<Drive> drive_of(ObjectId object, const OwnObject& own, SimTime at) const;
  std::size_t publish_update(ObjectId object, OwnObject& own, SimTime at, SimTime t, PublishReason reason,
                             double threshold_m);
  void flush_region(RegionId region, std::span<const Handover> handovers, std::span<EncodedUpdate> updates,
                    bool with_decisions);
  void send(Message& message, RegionId region, std::span<const EncodedUpdate> updates);

  const PeerConfig& config_;
  const Membership& members_;
  const Owners& owners_;
  OwnObjects& own_;
  Launches& launches_;
  Replica& replica_;
  RegionSubscriptions& regions_;
  ContactDecisions& decisions_;
  const TickGrid& ticks_;
  Outbox& outbox_;
  PeerCounters& counters_;
  ProximityThreshold thresholds_;
  UpdateRepeater repeater_;
  std::vector<EncodedUpdate> updates_due_, copies_due_;
  std::vector<Checked> not_due_;   // of this tick
  std::vector<Due> due_updates_;   // of this tick
  bool over_byte_budget_ = false;  // as of the last tick
};

}  // namespace peerd::replication
