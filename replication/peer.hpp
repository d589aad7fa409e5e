#pragma once
#include <cstdint>
#include <deque>
#include <expected>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <boost/container/flat_map.hpp>
#include <boost/container/flat_set.hpp>
#include <boost/container/small_vector.hpp>

#include "core/motion/predefined_motion.hpp"
#include "replication/wire/codec.hpp"
#include "replication/motion/colliding_objects.hpp"
#include "replication/motion/convergence.hpp"
#include "replication/decision/decision.hpp"
#include "replication/decision/decision_log.hpp"
#include "replication/interest/interest.hpp"
#include "replication/session/membership.hpp"
#include "replication/motion/motion_world.hpp"
#include "replication/output.hpp"
#include "replication/decision/owners.hpp"
#include "replication/peer_config.hpp"
#include "replication/peer_counters.hpp"
#include "replication/motion/position_history.hpp"
#include "replication/publish/publisher.hpp"
#include "replication/motion/schedule.hpp"
#include "replication/session/session_clock.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Pose and derivatives of a driven object at a tick, from whatever moves it. At a corner, the derivatives of what
// follows.
struct OwnSample {
  ObjectId object;
  KinematicState state;
  // False: only the pose is known; the rest is found from those before (position_history.hpp).
  bool has_derivatives = true;
};

// One peer, whole: replica, dead reckoning, prediction, decisions, session. Sans-IO: it owns no socket, clock, thread
// or source of randomness. `now` is this host's clock and must not run backwards. Single-threaded.
class Peer {
 public:
  using Counters = PeerCounters;

  // The model outlives the peer.
  Peer(PeerConfig config, const WorldModel& model);
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  // A datagram from the network: hostile until proven otherwise. An error says why it changed nothing.
  std::expected<void, Drop> on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram);
  // Does everything that is due at `now`; calling it early is harmless. `samples` are of the instant due_tick(now)
  // gave, one for each driven object, and are ignored when no tick is due.
  void on_tick(HostTime now, std::span<const OwnSample> samples);
  // The tick that on_tick(now) would do: the last point of the session's tick grid not after now. None: not due, or
  // not synchronised yet.
  [[nodiscard]] std::optional<SimTime> due_tick(HostTime now) const;
  // Between two ticks: what drives these objects has just moved them. Each that the others would believe too wrong is
  // told of now and not with the next tick, once at most until then; so is what change_velocity() has changed. Does
  // nothing where a tick is due: that tells. Samples are of `now`, with derivatives.
  void publish_now(HostTime now, std::span<const OwnSample> samples);
  // What this host's operating system says of its clock at `now`; none: that it does not know how right it is. Needed
  // for the preference of good OS clocks alone.
  void on_os_clock(HostTime now, std::optional<OsClock> clock);
  [[nodiscard]] const std::optional<OsClock>& os_clock() const { return os_clock_; }
  // The launches of own objects count from `start`, or from now if that has passed.
  void start_motions(HostTime now, SimTime start);
  // A vector in the frame of the object's parent, as the file has velocities: in the world's, as the parent stands
  // then.
  [[nodiscard]] Vec3 to_world(SimTime at, ObjectId object, const Vec3& in_parent);
  // PredefinedMotion::limited_at(): since when the world's TimeSensors stand still [s, world time].
  [[nodiscard]] std::optional<double> time_sensors_limited_at() const {
    return predefined_ ? predefined_->transition_limit_reached_at() : std::nullopt;
  }
  // A key or a hand changes the velocity [m/s, world frame] of an object that this peer runs and does not drive:
  // replaces it, or adds to it. False, and nothing done, for any other object and before a session. The others are told
  // by publish_now(), or with the next tick.
  bool change_velocity(HostTime now, ObjectId object, const Vec3& velocity, bool absolute);
  // Brings the ghosts to t, which may lie between two ticks: for a viewer with a frame rate of its own. Changes nothing
  // that the other peers could notice.
  void advance_ghosts(SimTime t);
  // Says goodbye. The peer is over after this.
  void leave(HostTime now);

  // From now on this peer's hellos say when motions by formula begin. Peers that run such motions together follow the
  // lowest peer's word. It is also time 0 of the world's TimeSensors where the session has none yet.
  void announce_start(SimTime start) {
    start_ = start;
    if (!world_zero_) world_zero_ = start;
    reintroduce();
  }
  // Session time at which the world's TimeSensors began, the same on all peers; none until one of them has said.
  [[nodiscard]] std::optional<SimTime> world_zero() const { return world_zero_; }

  [[nodiscard]] std::optional<Output> poll_output();
  // The memory of a datagram that has been sent, for those to come. Who hands it back makes sending cost none.
  void reuse(Bytes&& datagram);
  // When to call on_tick() next.
  [[nodiscard]] HostTime next_deadline() const;

  [[nodiscard]] PeerId id() const { return config_.id; }
  [[nodiscard]] const SessionClock& clock() const { return clock_; }
  // Whose session time this peer takes over; itself: it leads. None: nobody's yet.
  [[nodiscard]] std::optional<PeerId> follows() const { return follows_; }
  [[nodiscard]] const Membership& members() const { return members_; }
  [[nodiscard]] PeerId owner(ObjectId object) const { return owners_.of(object); }
  [[nodiscard]] const Owners& owners() const { return owners_; }
  // What this peer knows of an object that it runs, and what everybody believes of any object. Need a session. Of the
  // past 4 s; of own objects that something drives of the past half second, and of those that no interest names since
  // their last sample, unless they are shown late.
  [[nodiscard]] KinematicState truth(ObjectId object, SimTime t) const;
  [[nodiscard]] KinematicState ghost(ObjectId object, SimTime t) const;
  // Whether this peer hears of the object: false for what is in regions that it does not listen to. What it says of
  // those is void; they meet nothing here.
  [[nodiscard]] bool receives(ObjectId object) const { return !unreceived_.contains(object); }
  // The last update that counted, of others' objects; null before the first.
  [[nodiscard]] const UpdateRecord* last_update_of(ObjectId object) const;
  [[nodiscard]] const Interest& interest() const { return interest_; }
  // What a viewer draws. For each object, t never goes back; after look(t). It doesn't go through what an interest
  // pairs the object with, where the ghost didn't.
  [[nodiscard]] Pose shown(ObjectId object, SimTime t);
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] MotionWorld::Counters motion_counters() const;

 private:
  // Both worlds begin with the session. `truth` holds what is known: own objects as they are, and as believed those of
  // the others that may meet something. `ghosts` holds what the others believe, own objects included: the sender's copy
  // of every receiver's ghosts.
  struct Replica {
    MotionWorld truth, ghosts;
  };
  // Side by side: of few peers, looked at for every object.
  using FewPeers = boost::container::flat_set<PeerId, std::less<>, boost::container::small_vector<PeerId, 4>>;
  struct OwnObject {
    bool driven = false;
    std::optional<SimTime> last_sent;
    std::uint32_t sequence = 0;
    bool resend = false;  // somebody joined, or may not have what was told last
    bool republish = false;  // what was told last was not true
    Launch launch;
    std::optional<UpdateRecord> to_repeat;
    bool copying = false;                // it is in copying_
    std::uint32_t times_sent = 0;        // to_repeat, but for with hellos
    std::uint32_t times_with_hello = 0;  // .. and so often with hellos,
    HostTime with_hello_at{};            // the last time then
    // Of its last update: the numbers of the datagrams that carried it to all, and who is known to have one of them.
    std::vector<std::uint32_t> sent_in;
    FewPeers acknowledged_by;
    FewPeers unacknowledged_by;  // who has not confirmed the last but one, although there was time for it
    std::optional<ModelChooser> models;
    PoseHistory poses;  // of samples without derivatives
    UpdateBudget budget;
    double interval_s = 0.25;  // between updates, of late
    double bounding_radius_m = 0.0;      // of its vertices, where errors count by its surface
    // Regions (peer_regions.cpp).
    std::optional<Vec3> published_position;  // where the last update had it
    bool copy_until_received = false;     // somebody may know nothing of the object but by that update
    double contact_range_m = 0.0;  // what others run and it may collide with touches it from no farther; 0: nothing
  };

  [[nodiscard]] std::expected<void, Drop> admit(HostTime now, const Message& message);
  void enter_session(HostTime now);
  void launch(SimTime at, ObjectId object, OwnObject& own);
  void begin_motions(SimTime until);
  void move_to_session_time(SimTime before, SimTime now);
  void declare_all();
  void declare_remote(ObjectId object, Role role);
  [[nodiscard]] std::unexpected<Drop> on_other_world(const Message& message);
  void on_other_version();
  void on_unintroduced_peer(HostTime now, PeerId sender);
  void on_hello(HostTime now, PeerId sender, std::uint32_t number, const Hello& hello);
  void on_echo(PeerId sender, Member& member, const Echo* echo, std::span<const Echo> all);
  void on_update(PeerId sender, std::uint32_t number, UpdateRecord& update, SimTime session_now);
  void on_decision(PeerId sender, std::uint32_t number, const DecisionRecord& decision, SimTime known_at);
  void claim(PeerId peer, std::span<const ObjectId> objects);
  void resend_all();
  void orphan_objects_of(PeerId peer, HostTime now);
  void lose_peer(PeerId peer, const std::string& name, HostTime now, bool left_gracefully);
  void watch_decided_pairs();
  void watch_decided_pairs(std::span<const std::uint32_t> pairs);
  void watch_pairs_around(std::span<const ObjectId> objects);
  void restart_predefined_motion();
  void extend_predefined(SimTime to);
  bool maintain_session(HostTime now);
  // Whose time it is (peer_clock.cpp).
  // After a longer gap between two ticks this peer was stopped, or its computer asleep. What would have happened
  // meanwhile is not made up: for everybody else its objects stood still.
  static constexpr Duration kSuspendedAfter = std::chrono::seconds(4);
  [[nodiscard]] bool may_respond(HostTime now, const Member& member) const;
  bool found_session(HostTime now);
  bool detect_suspension(HostTime now);
  void on_stamps(HostTime now, Member& member, const Hello& hello, const Echo* echo);
  [[nodiscard]] std::optional<OsClockNote> os_clock_note(HostTime now) const;
  [[nodiscard]] SessionClock::Estimate estimate(HostTime now, PeerId peer);
  [[nodiscard]] std::optional<OffsetBounds> os_bounds(HostTime now, const Member& member) const;
  enum class Session : std::uint8_t { kUnknown, kEarlier, kSame, kLater };
  [[nodiscard]] Session session_of(HostTime now, const Member& member, Duration own_error) const;
  [[nodiscard]] std::optional<PeerId> choose_leader(HostTime now) const;
  void follow_leader(HostTime now, std::optional<PeerId> sender);
  void tick(SimTime t, std::span<const OwnSample> samples);
  void report_contacts(SimTime t);
  // Decisions (peer_decisions.cpp).
  [[nodiscard]] bool has_two_owners(ObjectId a, ObjectId b) const;
  [[nodiscard]] bool is_decision_server() const;
  [[nodiscard]] bool may_decide(PeerId peer, PeerId owner_a, PeerId owner_b) const;
  [[nodiscard]] bool searches_contacts_of(ObjectId a, ObjectId b) const;
  [[nodiscard]] PeerId choose_decider(ObjectId a, ObjectId b, SimTime contact) const;
  [[nodiscard]] bool reaches_all_in_time(SimTime contact) const;
  [[nodiscard]] ContactAuthority contact_authority(ObjectId a, ObjectId b, SimTime contact) const;
  [[nodiscard]] std::optional<Pose> camera_pose(const Viewpoint& viewpoint, SimTime at) const;
  [[nodiscard]] Contender contender(ObjectId object, SimTime at, std::span<const WorldBox> meeting) const;
  [[nodiscard]] Duration own_latency() const;
  [[nodiscard]] Duration longest_latency() const;
  [[nodiscard]] Duration lookback() const;
  void begin_worlds(SimTime now);
  void measure_latency(Member& member, HostTime now, SimTime sent);
  void decide(const ContactEvent& contact, SimTime known_at);
  void defer_contact(const ContactEvent& contact);
  [[nodiscard]] bool awaits_decision_on(ObjectId object) const;
  void on_contact_notes(PeerId sender, const Hello& hello, SimTime known_at);
  void resolve_overdue_contacts(SimTime t);
  void decide_by_fallback(const ContactEvent& contact, SimTime known_at);
  [[nodiscard]] bool may_have_missed_our_update(PeerId peer, const ContactEvent& contact) const;
  [[nodiscard]] ContactEvent within_wire_limits(ContactEvent contact);
  [[nodiscard]] DecisionRecord record_of(const ContactEvent& contact, DecisionRule rule) const;
  std::vector<DecisionLog::Change> add_own_decision(const DecisionRecord& record);
  void apply_changes(const std::vector<DecisionLog::Change>& changes, SimTime known_at);
  void apply_decision(const DecisionRecord& decision, PeerId author, SimTime known_at);
  void rebase(ObjectId object, SimTime from);
  void on_acknowledgement(PeerId sender, const Acknowledgement& acknowledgement);
  void repeat_unacknowledged_decisions();
  void repeat(DecisionLog::Entry& own);
  [[nodiscard]] bool is_acknowledged_by_all(const DecisionLog::Entry& own) const;
  [[nodiscard]] std::vector<ContactNote> contact_notes_to_send();
  void publish(SimTime t);
  void publish_piggybacked(SimTime t);
  void publish_most_urgent(SimTime t);
  void publish_changed(SimTime t);
  [[nodiscard]] bool update_is_redundant(ObjectId object, const OwnObject& own, SimTime t, const KinematicState& truth,
                              const KinematicState& ghost) const;
  [[nodiscard]] std::optional<PublishReason> why_due(ObjectId object, OwnObject& own, SimTime t, double threshold_m,
                                                     const KinematicState& truth, const KinematicState& ghost,
                                                     const GhostError& error);
  [[nodiscard]] double least_threshold_m(ObjectId object) const;
  [[nodiscard]] bool published_since_tick(const OwnObject& own) const;
  [[nodiscard]] bool tracks_acknowledgements() const;
  [[nodiscard]] SimTime next_check(ObjectId object, const OwnObject& own, SimTime t, const GhostError& error) const;
  void schedule_check(ObjectId object);
  void schedule_all_checks();
  void schedule_checks_of_changed();
  void index_own_objects();
  void republish(ObjectId object);
  void repeat_updates(HostTime now);
  std::size_t publish_update(ObjectId object, OwnObject& own, SimTime at, SimTime t, PublishReason reason, double threshold_m);
  [[nodiscard]] bool may_pass(ObjectId object, SimTime since, SimTime t, const Vec3& from, const Vec3& to) const;
  [[nodiscard]] double threshold_now_m(ObjectId object, SimTime t);
  [[nodiscard]] double time_to_contact_s(ObjectId object, SimTime t, double threshold_m);
  [[nodiscard]] Duration display_delay() const;
  void set_ghost(ObjectId object, SimTime t, const MotionModel& model);
  [[nodiscard]] Duration farthest_latency() const;
  void observe(ObjectId object, OwnObject& own, SimTime t, double latency_s);
  [[nodiscard]] bool is_worth_an_update(OwnObject& own, SimTime t, const GhostError& error);
  // Regions (peer_regions.cpp).
  [[nodiscard]] Duration state_request_takes() const;
  [[nodiscard]] Duration lookahead() const;
  [[nodiscard]] std::optional<std::vector<Area>> areas(SimTime t) const;
  void follow_interest(SimTime t);
  void join(RegionId region);
  void request_states_of(RegionId region);
  void leave_region(RegionId region, SimTime t);
  [[nodiscard]] std::vector<Subscription> take_subscriptions(std::size_t most, bool goes_anyway);
  void announce_subscriptions();
  void on_subscriptions(PeerId sender, std::span<const Subscription> subscriptions, SimTime session_now);
  [[nodiscard]] bool accept_by_region(const UpdateRecord& update, SimTime session_now);
  void leave_interest(ObjectId object, SimTime t);
  void stop_receiving(ObjectId object);
  [[nodiscard]] std::size_t pairs_with_received(ObjectId object) const;
  void expire_silent_objects(SimTime t);
  [[nodiscard]] bool has_left_region(const OwnObject& own, const Vec3& position) const;
  void note_published(OwnObject& own, const UpdateRecord& update, bool receiver_may_hold_nothing);
  void announce_handover(const UpdateRecord& update, RegionId from, RegionId to);
  [[nodiscard]] RegionId region_of_object(ObjectId object) const;
  void republish_across_regions(const ContactEvent& contact);
  // What goes to one region.
  struct Batch {
    std::vector<Handover> handovers;
    std::vector<EncodedUpdate> updates;
  };
  void sort_handovers(std::map<RegionId, Batch>& due);
  void on_handovers(PeerId sender, std::span<const Handover> handovers, SimTime session_now);
  void measure_contact_ranges(std::span<const std::uint32_t> pairs);
  void send_copies();
  void copy_later(ObjectId object, OwnObject& own);
  void flush_records(bool decisions);
  void flush_region(RegionId region, std::span<const Handover> handovers, std::span<EncodedUpdate> updates, bool decisions);
  [[nodiscard]] bool settled(HostTime now) const;
  void send_hello(HostTime now, bool leaving);
  void send_keepalive();
  void reintroduce();
  [[nodiscard]] bool must_introduce() const;
  [[nodiscard]] Introduction introduction();
  [[nodiscard]] bool is_acknowledged_by_all(const OwnObject& own) const;
  [[nodiscard]] Duration answered_within() const;
  void note_unacknowledged(OwnObject& own, SimTime t);
  [[nodiscard]] double loss() const;
  [[nodiscard]] double loss_of(const Member& member, double others) const;
  void send(Message& message, RegionId region = kWholeScene, std::span<const EncodedUpdate> updates = {});
  [[nodiscard]] Message blank() const;
  [[nodiscard]] std::int64_t tick_number(SimTime t) const;
  [[nodiscard]] SimTime tick_time(std::int64_t number) const;
  void drop(const char* reason) { ++counters_.drops[reason]; }
  void drop(PeerId sender, const char* reason) {  // part of what it said
    drop(reason);
    if (Member* member = members_.find(sender)) ++member->drops[reason];
  }

  PeerConfig config_;
  const WorldModel& model_;
  SessionClock clock_;
  Membership members_;
  boost::container::flat_map<ObjectId, OwnObject> own_objects_;
  // When a tick has to look at each own object next, by its place in own_; and that by the object.
  Schedule checks_;
  static constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> own_index_;
  Owners owners_;  // own objects included
  DecisionLog decisions_;
  // Contacts that this peer has found and another is to decide.
  struct DeferredContact {
    ContactEvent contact;
    PeerId decider;
  };
  std::vector<DeferredContact> deferred_contacts_;
  std::unordered_map<ObjectId, UpdateRecord> last_updates_;  // of others' objects: the last update that was applied
  std::optional<Replica> replica_;
  CollidingObjects colliding_;  // in the world as this peer knows it
  std::map<ObjectId, Convergence> shown_;
  Duration oldest_update_{0};  // when it came
  std::optional<HostTime> started_;
  HostTime listening_since_{};           // .. or since this host slept
  std::optional<HostTime> called_at_;  // last
  bool was_suspended_ = false;                 // since it had session time last
  std::optional<OsClock> os_clock_;
  HostTime os_clock_at_{};
  std::optional<PeerId> world_zero_source_;  // who brought this peer into its session, and knows its world_zero
  std::optional<SimTime> start_;
  std::optional<SimTime> world_zero_;
  std::optional<SimTime> previous_world_zero_;          // what it was before that, in the time of now
  std::optional<PredefinedMotion> predefined_;  // where the file moves any body
  bool clock_stepped_ = false;
  // Until when both worlds know how what the file moves goes on (none: they don't yet), and until when a peer ran it.
  struct Predefined {
    ObjectId object;
    std::optional<SimTime> known_until, run_until;
  };
  std::vector<Predefined> predefined_pieces_;
  std::map<ObjectId, SimTime> scheduled_launches_;   // own objects that stand until then
  std::map<ObjectId, SimTime> unpublished_changes_;  // .. that began to move then as nobody could know; not told yet
  std::optional<HostTime> next_hello_;
  HostTime last_hello_{}, last_sent_at_{};  // last_said_: anything, to all,
  std::uint32_t last_sent_number_ = 0;               // .. a datagram of that number
  // Whoever comes measures its clock and its loss with hellos: so long they are not rare.
  static constexpr Duration kSettling = std::chrono::seconds(4);
  HostTime settling_until_{};
  std::optional<HostTime> unintroduced_peer_at_;  // somebody is here who has not introduced itself yet
  std::optional<PeerId> follows_;
  std::uint32_t sessions_ = 0;  // entered
  std::int64_t last_tick_ = 0;
  std::size_t hellos_ = 0, introductions_ = 0, echo_turns_ = 0;  // sent; their lists take turns
  std::size_t introductions_due_ = 0;                            // with the next hellos: something new is in them
  struct SentHello {
    std::uint32_t number;
    HostTime at;
  };
  std::deque<SentHello> sent_hellos_;  // of the last kHeldMax
  std::map<RegionId, std::uint32_t> datagram_numbers_;
  RegionGrid grid_;
  Interest interest_;
  double remote_reach_m_ = 0.0;  // of the vertices of what others have ever run
  struct LastReception {
    RegionId region;
    SimTime at{};                    // when this peer heard it
    std::optional<SimTime> requested_at{};  // .. and whether it is still there, for want of a word
  };
  std::map<ObjectId, LastReception> last_receptions_;  // others' objects: where they were told of last
  std::set<ObjectId> unreceived_;          // .. and those that this peer does not hear of
  std::size_t unreceived_pairs_ = 0;       // of those, with whatever
  struct PendingSubscription {
    Subscription subscription;
    std::uint32_t copies;   // still to be sent
    std::uint32_t repeats;  // .. and so many after these, some time apart
    std::optional<SimTime> sent_at{};
  };
  std::vector<PendingSubscription> pending_subscriptions_;
  // Of own objects, in no region that they are told in.
  struct PendingHandover {
    Handover handover;
    RegionId from;
    std::uint32_t copies, repeats;  // as above
    std::optional<SimTime> sent_at{};
  };
  std::vector<PendingHandover> pending_handovers_;
  std::vector<EncodedUpdate> updates_due_, copies_due_;
  std::vector<ObjectId> copying_;  // own objects whose last update may have to go out once more;
  std::uint32_t copies_wanted_ = 1;       // how often, at most, the loss of the last tick asked for
  Codec codec_;
  std::vector<Bytes> spare_;  // memory for datagrams
  // Own objects that no update is due of, at this tick.
  struct NotDue {
    ObjectId object;
    OwnObject* own;
    GhostError error;
    double threshold_m;
  };
  std::vector<NotDue> not_due_;
  // Those that one is due of, where bytes are counted.
  struct Due {
    NotDue what;
    PublishReason reason;
    double urgency = 0.0;
  };
  std::vector<Due> due_updates_;
  ByteBudget bytes_;
  bool over_byte_budget_ = false;               // as of the last tick
  std::set<PeerId> other_worlds_;           // told once each
  std::set<std::uint32_t> other_versions_;  // .. each
  // Lost; what they were told is to be told again when they come back. How many hellos have left each out since.
  std::map<PeerId, std::size_t> lost_peers_;
  std::map<PeerId, std::uint64_t> departed_peers_;  // who has said goodbye: the boot of that life
  bool id_in_use_reported_ = false;
  std::vector<Output> outputs_;
  std::size_t polled_ = 0;  // of outputs_
  Counters counters_;
};

}  // namespace peerd::replication
