#include "replication/peer/operation_keeper.hpp"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>
#include <variant>

#include "core/edit/number_text.hpp"
#include "core/edit/placement.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/lexer.hpp"
#include "replication/peer/contact_report.hpp"
#include "replication/physics/laws/composed_motion.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::replication {
namespace {

// An operation takes effect so long after it was made, at least; twice the longest latency of the session otherwise.
constexpr Duration kLeadMin = std::chrono::milliseconds(100);
// An edit of longer ago does not change any more what has happened since, as a decision on that is made
// no more (contact_decisions.cpp).
constexpr Duration kLateMax = std::chrono::seconds(3);
// The peer of the lowest id says where left objects stand; where it is gone, too, another one does within this time.
constexpr Duration kPlacedWithin = std::chrono::seconds(10);
// A peer that received an object, where regions cut the world, leaves this time to every lower one that is near to say
// first where the object stands: mostly longer than an operation is under way.
constexpr Duration kTurn = std::chrono::milliseconds(150);
// Peers that have only received the object earlier say it from then on, in the same turns.
constexpr Duration kUnseenAfter = std::chrono::seconds(4);
// A hello's datagram leaves so much besides its lists at most.
constexpr std::size_t kMargin_bytes = 16;

// The value of an SFVec3f. The caller has found that it is one.
std::optional<Vec3> vector_in(std::string_view text) {
  vrml::Lexer lexer(text);
  Vec3 vector = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto number = vrml::read_float(lexer.next().text);
    if (!number) return std::nullopt;
    vector[i] = *number;
  }
  return vector;
}

}  // namespace

OperationKeeper::OperationKeeper(PeerParts& parts, SessionKeeper& keeper)
    : p_(parts), keeper_(keeper), limits_(parts.logs, parts.members, parts.limits) {
  const LivingScene::NextIds next = p_.living.next_ids(p_.author);
  next_object_ = next.object;
  next_node_ = next.node;
}

void OperationKeeper::note_growth(AuthorId author, std::uint64_t whole_before) {
  const std::uint64_t whole = p_.logs.whole(author);
  assert(whole >= whole_before);
  if (whole == whole_before || withheld_.contains(author)) return;
  if (!p_.replica.begun() && author != p_.author) {  // this peer has no time yet to compare stamps with
    withheld_.emplace(author, Withheld{.from = whole_before, .stamp = SimTime::min(), .operations = 0});
    return;
  }
  const std::uint64_t kept = author == p_.author ? whole : withhold_far_stamps(author, whole_before);
  const std::uint32_t later = kept == whole ? 0 : withheld_.at(author).operations;
  if (kept == whole_before) return;
  p_.outbox.push(LogGrown{{author, whole_before, kept}, {author, p_.logs.last(author).number - later}});
}

// A store would make the scene of them when this peer starts again, and its time would go on behind them: it gets a log
// up to the first stamp that is far ahead, and the rest when that is not far ahead any more. Returns the end of what it
// gets, of whole operations from `from` on.
std::uint64_t OperationKeeper::withhold_far_stamps(AuthorId author, std::uint64_t from) {
  const std::uint64_t whole = p_.logs.whole(author);
  if (p_.logs.last_stamp(author) <= far_ahead_) return whole;
  std::uint64_t at = from, end = whole;
  Withheld withheld;
  const auto grown = p_.logs.bytes({author, from, whole});
  while (at < whole) {
    const auto next = decode_operation(author, std::span(grown).subspan(at - from));
    assert(next && *next);  // the log has read it
    if (withheld.operations > 0 || (*next)->operation.stamp > far_ahead_) {
      if (withheld.operations++ == 0) {
        end = at;
        withheld.stamp = (*next)->operation.stamp;
      }
    }
    at += (*next)->size_bytes;
  }
  withheld.from = end;
  withheld_.emplace(author, withheld);
  return end;
}

void OperationKeeper::give_withheld() {
  std::vector<std::pair<AuthorId, std::uint64_t>> due;
  for (const auto& [author, withheld] : withheld_) {
    if (withheld.stamp <= far_ahead_) due.emplace_back(author, withheld.from);
  }
  for (const auto& [author, from] : due) {
    assert(author != p_.author && from < p_.logs.whole(author));
    withheld_.erase(author);
    note_growth(author, from);  // what is behind it may be farther ahead
  }
}

SimTime OperationKeeper::stamp(HostTime now) const {
  const SimTime session_now = p_.to_session(now);
  const SimTime all_have_it = session_now + std::max<Duration>(kLeadMin, 2 * p_.members.longest_latency());
  // Its own last one counts wherever it is: the stamps of a log grow.
  SimTime last = p_.living.last_stamp(session_now + kStampAheadMax);
  if (p_.logs.last(p_.author).number > 0) last = std::max(last, p_.logs.last_stamp(p_.author));
  return std::max(all_have_it, last == SimTime::min() ? last : last + Duration{1});
}

std::expected<OperationId, std::string> OperationKeeper::edit(HostTime now, OperationBody body) {
  if (!p_.replica.begun()) return std::unexpected("this peer is in no session yet");
  if (auto* const add = std::get_if<AddNodes>(&body)) {
    add->first_object = next_object_;
    add->first_node = next_node_;
  }
  if (auto* const set = std::get_if<SetField>(&body)) set->first_node = next_node_;
  auto draft = p_.living.draft(std::move(body), p_.author, p_.to_session(now) + kStampAheadMax);
  if (!draft) return std::unexpected(draft.error());
  const auto* const set = std::get_if<SetField>(&draft->body);
  if (const auto place = set == nullptr ? std::nullopt : place_to_drift_from(now, *set)) {
    if (const auto placed = edit(now, *place); !placed) return placed;
  }
  return append(now, *std::move(draft));
}

// The world's own movement displaces a Transform by its velocityVector times the world time (Ohlenburg 2003, equation
// C.1). Whoever sets another one means from now on, and not from the world's beginning: the translation changes with
// it, so that the object goes on from where it is. Returns that edit, where there is such a movement.
std::optional<SetField> OperationKeeper::place_to_drift_from(HostTime now, const SetField& set) const {
  const auto zero = p_.world_time.zero();
  const std::optional<Vec3> velocity = set.field == "velocityVector" ? vector_in(set.value) : std::nullopt;
  if (!velocity || !zero) return std::nullopt;
  const Scene& scene = *p_.model->scene;
  const auto is_of_node = [&](const Instance& i) { return scene.document->ids.id_of(i.node) == set.node; };
  const auto instance = std::ranges::find_if(scene.instances, is_of_node);
  if (instance == scene.instances.end()) return std::nullopt;
  const auto is_driven = [&](const vrml::Route& r) {
    return r.to_node == instance->node && r.to->name == "translation";
  };
  const ObjectId object = scene.id_of(static_cast<std::uint32_t>(instance - scene.instances.begin()));
  if (std::ranges::any_of(scene.document->routes, is_driven)) return std::nullopt;
  if (owner_of(object) != kNobody || p_.scene.is_moved(object)) return std::nullopt;
  const double since_s = std::max(0.0, to_seconds(stamp(now) - *zero));
  const Vec3 by = since_s * (scene.object(object).velocity - *velocity);
  if (by.isZero(0.0)) return std::nullopt;
  const Eigen::Vector3f place = (scene.transform(object).translation + by).cast<float>();
  return SetField{set.node, "translation", text_of_numbers({place.data(), 3}), 0};
}

std::expected<OperationId, std::string> OperationKeeper::append(HostTime now, LivingScene::Draft draft) {
  const OperationId id{p_.author, p_.logs.last(p_.author).number + 1};
  Operation operation{id, stamp(now), std::move(draft.body), p_.living.conflicts().news_for(p_.author)};
  const std::uint64_t whole_before = p_.logs.whole(p_.author);
  if (const std::size_t size = encode(operation).size(); size > kOperationMax_bytes) {
    return std::unexpected("it has " + std::to_string(size) + " bytes, and an operation may have " +
                           std::to_string(kOperationMax_bytes));
  }
  if (!limits_.has_room(id.author)) return std::unexpected("the log of this author is full");
  if (const auto appended = p_.logs.append(operation); !appended) return std::unexpected(appended.error());
  next_object_ += draft.objects;
  next_node_ += draft.nodes;
  p_.living.add(std::move(operation));
  note_growth(p_.author, whole_before);
  follow_link();
  p_.exchange.on_append(now, id);
  ++p_.counters.operations;
  send(now);
  return id;
}

std::expected<UndoneEdit, std::string> OperationKeeper::undo(HostTime now, bool redoes) {
  if (!p_.replica.begun()) return std::unexpected("this peer is in no session yet");
  const auto next = p_.living.next_undo(p_.author, redoes, p_.to_session(now) + kStampAheadMax);
  if (!next) return std::unexpected(next.error());
  const auto done = append(now, {next->undo, 0, 0});
  if (!done) return std::unexpected(done.error());
  return UndoneEdit{*done, {p_.author, next->undo.number}, kind_of(next->undone)};
}

PeerId OperationKeeper::owner_of(ObjectId object) const {
  const auto given = p_.living.owners().find(object);
  const bool is_given = given != p_.living.owners().end() && given->second != kNobody;
  return is_given ? given->second : p_.owners.of(object);
}

// The place of the own object at t, as its Transform would say it. None: the scene says the same, or it moves on.
std::optional<Placement> OperationKeeper::placement_at(SimTime t, ObjectId object) const {
  const KinematicState state = p_.replica.truth().relative_at(object, t);
  const bool moves = state.velocity != Vec3::Zero() || state.angular_velocity_body != Vec3::Zero();
  if (moves && p_.is_scene_object(*p_.model, object)) return std::nullopt;
  return placement_of_state(object, state);
}

// The same of a state in the frame of the object's carrier.
std::optional<Placement> OperationKeeper::placement_of_state(ObjectId object, const KinematicState& state) const {
  const Scene& scene = *p_.model->scene;
  const auto carrier = p_.model->carrier_of(object);
  const Pose world = carrier ? composed(at_rest(scene.rigid_pose(*carrier)), state).pose() : state.pose();
  const auto placement = placement_of(scene, object, world);
  return placement == placement_of(scene, object, scene.rigid_pose(object)) ? std::nullopt : placement;
}

std::expected<OperationId, std::string> OperationKeeper::give(HostTime now, ObjectId object, PeerId to) {
  GiveObject give{object, to, owner_of(object)};
  if (to == kNobody && p_.replica.begun() && p_.own.contains(object)) give.placement = placement_at(stamp(now), object);
  return edit(now, give);
}

std::expected<Taking, std::string> OperationKeeper::own(HostTime now, ObjectId object, bool steals) {
  if (steals && !p_.config.may_steal) {
    return std::unexpected("this world's settings do not allow it (replication.steal)");
  }
  PeerId owner = owner_of(object);
  const bool is_released = p_.living.owners().contains(object);  // an operation has, whatever was introduced before
  if (owner == kNobody && !is_released) owner = p_.members.far_owner(object);
  const bool asks = !steals && owner != p_.config.id && p_.members.contains(owner);
  const auto operation = asks ? edit(now, RequestObject{object, owner, p_.config.id}) : give(now, object, p_.config.id);
  if (!operation) return std::unexpected(operation.error());
  return Taking{*operation, asks};
}

void OperationKeeper::place_left_behind(HostTime now, SimTime t) {
  if (p_.left_behind.empty()) return;
  // In a large session an owner that is silent here may only be elsewhere: its far hello says so by then.
  const Duration unsure = p_.members.is_large() ? p_.members.far_patience() : Duration{0};
  std::erase_if(p_.left_behind, [&](const auto& each) {
    return p_.owners.of(each.first) != kNobody || t - each.second.at > unsure + kPlacedWithin;
  });
  const auto lowest = p_.members.lowest();
  const bool is_first = !lowest || p_.config.id < *lowest;
  const auto is_lower = [&](const auto& member) { return member.second.synchronised && member.first < p_.config.id; };
  const auto lower = std::ranges::count_if(p_.members.all(), is_lower);
  const Duration turn = std::min<Duration>(lower * kTurn, kPlacedWithin / 2);
  const auto is_our_turn = [&](const LeftBehind& left) {
    return t - left.at >= unsure + (left.was_received ? Duration{0} : Duration{kUnseenAfter}) + turn;
  };
  for (const auto& [object, left] : std::map(p_.left_behind)) {
    // A locked object is placed by those who may.
    const bool is_locked = p_.living.lock_around(object).has_value();
    if (is_locked && !p_.living.why_locked(object, p_.author).empty()) continue;
    if (p_.regions.cuts() ? !is_our_turn(left) : !is_locked && !is_first) continue;
    p_.left_behind.erase(object);
    p_.replica.compute_ghost(object);
    const auto placement = placement_of_state(object, p_.replica.ghosts().relative_at(object, t));
    if (!placement) continue;  // it stands where the scene has it, or is of a node that has no place of its own
    if (!edit(now, PlaceObject{object, left.owner, t, *placement})) ++p_.counters.drops["place_object"];
  }
}

// The own objects among these that their owner has gone on with, while others took it for gone.
std::set<ObjectId> OperationKeeper::going_on(const LeftObjects& left) const {
  std::set<ObjectId> all;
  for (const auto& [object, each] : left) {
    if (p_.own.contains(object) && each.at > p_.presence.since()) all.insert(object);
  }
  return all;
}

// Passes on what concerns this peer of requests and answers. Old ones come with the log.
void OperationKeeper::on_request(const Operation& operation, SimTime session_now) {
  if (operation.stamp < session_now - kAnsweredWithin) return;
  const auto* const request = std::get_if<RequestObject>(&operation.body);
  const bool is_ours = request != nullptr && request->owner == p_.config.id && request->by != p_.config.id;
  if (is_ours) p_.outbox.push(ObjectRequested{operation.id, request->object, request->by});
  const auto* const refusal = std::get_if<RefuseRequest>(&operation.body);
  if (refusal != nullptr && refusal->request.author == p_.author) {
    p_.outbox.push(RequestRefused{refusal->request, refusal->reason});
  }
}

void OperationKeeper::on_message(HostTime now, PeerId sender, const Message& m) {
  const bool has_logs = m.hello && !m.hello->logs.empty();
  if (has_logs || !m.operations.empty() || !m.operation_requests.empty()) follow_link();
  for (const OperationPart& part : m.operations) {
    if (!limits_.admit(now, sender, part)) continue;
    const std::uint64_t whole_before = p_.logs.whole(part.author);
    auto taken = p_.logs.receive(part);
    note_growth(part.author, whole_before);
    p_.exchange.on_part(now, sender, part);
    if (!taken) {
      p_.drop(sender, taken.error());
      continue;
    }
    for (Operation& operation : *taken) {
      ++p_.counters.operations_in;
      if (p_.replica.begun()) {
        on_request(operation, p_.to_session(now));
        // After a stop this peer does not know session time, and judges nobody's.
        if (p_.time.clock().synchronised()) {
          limits_.note_stamp(now, sender, operation.stamp, p_.to_session(now));
        }
      }
      p_.living.add(std::move(operation));
    }
  }
  if (limits_.admit(now, sender, m.operation_requests)) p_.exchange.on_requests(now, sender, m.operation_requests);
  if (m.hello) p_.exchange.on_lengths(now, sender, limits_.admit(now, sender, m.hello->logs));
}

// Messages are for those who were there when they were sent, be it apart from the sender.
void OperationKeeper::publish_data(const LivingScene::Change& change) {
  for (const NodeData::Change& each : change.data) {
    p_.outbox.push(DataChanged{each.node, each.key, each.value, change.at});
  }
  for (const Operation& each : change.messages) {
    if (!p_.presence.was_there(each.stamp)) continue;
    const auto& message = std::get<SendMessage>(each.body);
    p_.outbox.push(MessageReceived{each.id, message.by, message.topic, message.text, each.stamp});
  }
}

void OperationKeeper::apply_until(SimTime t, const std::function<void(SimTime)>& before_advancing) {
  assert(p_.replica.begun());
  far_ahead_ = t + kStampAheadMax;
  if (!withheld_.empty()) give_withheld();
  const SimTime known = std::min(applied_until_, t);
  while (const auto change = p_.living.apply(t, known)) {
    for (const LivingScene::Outcome& outcome : change->outcomes) {
      p_.outbox.push(SceneEdited{outcome.id, change->at, outcome.refused});
    }
    publish_data(*change);
    if (!change->scene && change->given.empty()) continue;
    const SimTime at = std::max({change->at, t - kLateMax, p_.replica.begun_at()});
    const SimTime now = std::max(at, known);
    before_advancing(now);
    p_.advance_worlds(now);
    report_contacts(p_, now);
    keeper_.give(change->given, at);  // before: what nobody owns from now on goes to its place in the scene
    if (!change->scene) continue;
    p_.change_scene(change->scene, at, going_on(change->left), change->fields);
    for (const auto& [object, left] : change->left) p_.left_behind.erase(object);
    keeper_.follow_scene();
    keeper_.give(change->given, at);  // what is new in it
    keeper_.give_back_removed(at);
  }
  applied_until_ = t;
}

void OperationKeeper::follow_link() {
  const Duration tick = Duration{std::chrono::seconds(1)} / p_.config.tick_hz;
  p_.exchange.set_link(p_.members.longest_latency() + 2 * tick, p_.members.worst_loss_to_peers());
}

void OperationKeeper::send(HostTime now) {
  for (const OperationId id : p_.exchange.newly_held()) p_.outbox.push(OperationHeld{id});
  if (const auto due = p_.exchange.next_deadline(); !due || *due > now) return;
  follow_link();
  for (OperationMessage& due : p_.exchange.on_tick(now)) {
    Message m = p_.outbox.blank();
    m.operations = std::move(due.operations);
    m.operation_requests = std::move(due.operation_requests);
    p_.outbox.send(m);
  }
}

void OperationKeeper::add_lengths(Message& m) {
  assert(m.hello);
  if (p_.logs.empty()) return;
  const std::size_t used = encode(m).size() + kMargin_bytes;
  if (used < kDatagramMax_bytes) m.hello->logs = p_.exchange.lengths_for_hello(kDatagramMax_bytes - used);
}

}  // namespace peerd::replication
