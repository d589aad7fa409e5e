#include "tests/sim/dissector/expected.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "peerd/input/compression.hpp"
#include "peerd/net/discovery/beacon.hpp"
#include "peerd/net/snapshot/snapshot_message.hpp"

namespace peerd::sim::dissector_test {

using namespace replication;

namespace {

constexpr std::array kKinds{"add_nodes",    "remove_object",  "remove_node",    "move_object",    "set_field",
                            "change_route", "give_object",    "request_object", "refuse_request", "set_data",
                            "send_message", "undo_operation", "place_object",   "lock_object"};
static_assert(kKinds.size() == std::variant_size_v<OperationBody>, "a kind of operation that the dissector lacks?");

bool is_identity(const Quat& q) { return q.coeffs() == Quat::Identity().coeffs(); }

void add(Expected& out, const Hello& h, std::uint64_t incarnation) {
  if (h.session_tx) out.add("hello.session_tx_ns", *h.session_tx);
  if (h.sessions != 0) out.add("hello.sessions", h.sessions);
  if (h.latency != Duration{0}) out.add("hello.latency_ms", h.latency / std::chrono::milliseconds(1));
  if (h.clock_error) out.add("hello.clock_error_us", *h.clock_error / std::chrono::microseconds(1));
  if (h.os_clock) {
    if (h.os_clock->minus_session != Duration{0}) {
      out.add("hello.os_minus_session_ns", h.os_clock->minus_session.count());
    }
    out.add("hello.os_error_us", h.os_clock->error / std::chrono::microseconds(1));
  }
  for (const Echo& e : h.echoes) {
    out.add("echo.peer", e.peer.value);
    out.add("echo.hello", e.hello);
    out.add("echo.held_ns", e.hold_time.count());
    const Received& r = e.received;
    out.add("echo.newer", r.highest - e.hello);
    out.add("echo.run", r.run);
    if (r.run < std::min(r.highest, Received::kWindow)) out.add("echo.absent", ~r.last >> r.run);
    out.add("echo.loss_permille", std::lround(e.loss * 1000.0));
  }
  for (const ContactNote& n : h.notes) {
    out.add("note.collider", n.collider.packed());
    out.add("note.collidee", n.collidee.packed());
    out.add("note.contact_ns", n.contact);
    out.add("note.held", n.deferred);
  }
  if (h.scene_digest != 0) out.add("hello.scene_digest", h.scene_digest);
  for (const LogLength& log : h.logs) {
    out.add("log.author", log.author.value);
    out.add("log.bytes", log.bytes);
  }
  if (!h.introduction) return;
  const Introduction& i = *h.introduction;
  out.add("introduction.name", i.name);
  if (i.world_hash != 0) out.add("introduction.world_hash", i.world_hash);
  if (incarnation != 0) out.add("introduction.boot", incarnation);
  for (const ObjectId object : i.owned) out.add("introduction.enslaved", object.packed());
  if (i.owned_as_founder != 0) out.add("introduction.owned_as_founder", i.owned_as_founder);
  if (i.start) out.add("introduction.start_ns", *i.start);
  if (i.world_zero) out.add("introduction.world_zero_ns", *i.world_zero);
  if (i.line != 0) out.add("introduction.line", i.line);
  if (i.has_edits) out.add("introduction.has_edits", true);
  if (!i.viewpoint) return;
  if (i.viewpoint->object) out.add("viewpoint.object", i.viewpoint->object->packed());
  out.add("viewpoint.position", i.viewpoint->pose.position);
  out.add("viewpoint.orientation", i.viewpoint->pose.orientation);
  out.add("viewpoint.field_of_view", i.viewpoint->field_of_view);
  out.add("viewpoint.aspect", i.viewpoint->aspect);
}

void add(Expected& out, const UpdateRecord& u) {
  const auto kind = static_cast<int>(u.model.kind);
  const KinematicState& s = u.model.state;
  out.add("record.object", u.object.packed());
  if (u.carrier) out.add("record.carrier", u.carrier->packed());
  out.add("record.sequence", u.sequence);
  out.add("record.kind", kind);
  out.add("record.time_ns", u.at);
  if (u.decision != SimTime{}) out.add("record.decision_ns", u.decision);
  if (u.position_step_log2) {
    out.add("record.step_log2", *u.position_step_log2);
  } else {
    out.add("record.exact", true);
  }
  out.add("record.position", s.position);
  out.add("record.velocity", s.velocity);
  if (u.model.kind != MotionKind::kFirst) out.add("record.acceleration", s.acceleration);
  const bool oscillating = u.model.kind == MotionKind::kOscillating;
  if (oscillating || u.model.kind == MotionKind::kThird) out.add("record.jerk", u.model.jerk);
  if (oscillating || u.model.kind == MotionKind::kTurning) out.add("record.rate", u.model.rate_rad_s);
  if (!is_identity(s.orientation)) out.add("record.orientation", s.orientation);
  out.add("record.spin", s.angular_velocity_body);
  if (!u.model.angular_acceleration_body.isZero(0.0)) {
    out.add("record.spin_acceleration", u.model.angular_acceleration_body);
  }
  if (u.drive) {
    out.add("record.drive", u.drive->acceleration);
    out.add("record.driven_since_ns", u.drive->since);
  }
}

void add(Expected& out, const KinematicState& s) {
  out.add("decision.position", s.position);
  if (!s.velocity.isZero(0.0)) out.add("decision.velocity", s.velocity);
  if (!s.acceleration.isZero(0.0)) out.add("decision.acceleration", s.acceleration);
  if (!is_identity(s.orientation)) out.add("decision.orientation", s.orientation);
  if (!s.angular_velocity_body.isZero(0.0)) out.add("decision.spin", s.angular_velocity_body);
}

void add(Expected& out, const DecisionRecord& d) {
  if (d.collider.packed() != 0) out.add("decision.collider", d.collider.packed());
  if (d.collidee.packed() != 0) out.add("decision.collidee", d.collidee.packed());
  if (d.contact != SimTime{}) out.add("decision.contact_ns", d.contact);
  out.add("decision.normal", d.normal);
  for (const auto* s : {&d.collider_before, &d.collidee_before, &d.collider_after, &d.collidee_after}) add(out, *s);
  out.add("decision.rule", static_cast<int>(d.rule));
  if (d.known != SimTime{}) out.add("decision.known_ns", d.known);
  if (d.rests) out.add("decision.rests", true);
  if (d.collider_free) out.add("decision.collider_free", *d.collider_free);
  if (d.collidee_free) out.add("decision.collidee_free", *d.collidee_free);
}

template <std::size_t Count>
void add_numbers(Expected& out, const std::array<std::uint16_t, Count>& numbers) {
  for (const std::uint16_t number : numbers) out.add("ghosts.number", number);
}

void add_ghosts(Expected& out, const Message& m) {
  if (m.ghosts) {
    out.add("ghosts.time_ns", m.ghosts->at);
    add_numbers(out, m.ghosts->groups);
  }
  if (m.ghost_question) {
    out.add("ghosts.owner", m.ghost_question->owner.value);
    out.add("ghosts.region", m.ghost_question->region.value);
    out.add("ghosts.time_ns", m.ghost_question->at);
    out.add("ghosts.group", m.ghost_question->group);
    add_numbers(out, m.ghost_question->buckets);
  }
  const std::vector<UpdateRecord>& states = m.ghost_answer.states;
  if (!states.empty()) out.add("ghosts.time_ns", states.front().at);
  for (const UpdateRecord& u : states) add(out, u);
  for (const GhostReport& report : m.ghost_reports) {
    out.add("ghosts.reported", report.object.packed());
    out.add("ghosts.distance", static_cast<double>(report.distance_m));
  }
}

void add(Expected& out, const AddNodes& a) {
  if (a.parent) out.add("operation.parent", a.parent->packed());
  if (a.before) out.add("operation.before", a.before->packed());
  out.add_text("operation.text", a.text);
  out.add_unless_zero("operation.first_object", a.first_object);
  out.add_unless_zero("operation.first_node", a.first_node);
  for (const auto& [path, object] : a.names) {
    out.add_text("operation.name.path", path);
    out.add_unless_zero("operation.name.object", object.packed());
  }
}

void add(Expected& out, const RemoveObject& r) { out.add_unless_zero("operation.object", r.object.packed()); }

void add(Expected& out, const RemoveNode& r) { out.add_unless_zero("operation.node", r.node.packed()); }

void add(Expected& out, const MoveObject& m) {
  out.add_unless_zero("operation.object", m.object.packed());
  if (m.parent) out.add("operation.parent", m.parent->packed());
  if (m.before) out.add("operation.before", m.before->packed());
}

void add(Expected& out, const SetField& s) {
  out.add_unless_zero("operation.node", s.node.packed());
  out.add_text("operation.field", s.field);
  out.add_text("operation.value", s.value);
  out.add_unless_zero("operation.first_node", s.first_node);
}

void add(Expected& out, const ChangeRoute& c) {
  out.add_unless_zero("operation.route.from", c.from.packed());
  out.add_unless_zero("operation.route.to", c.to.packed());
  out.add_text("operation.route.event_out", c.event_out);
  out.add_text("operation.route.event_in", c.event_in);
  if (c.removes) out.add("operation.route.removes", 1);
}

void add(Expected& out, const Placement& placement) {
  constexpr std::array kAxes{".x", ".y", ".z", ".angle"};
  for (std::size_t i = 0; i < placement.translation.size(); ++i) {
    out.add(std::string("operation.translation") + kAxes[i], static_cast<double>(placement.translation[i]));
  }
  for (std::size_t i = 0; i < placement.rotation.size(); ++i) {
    out.add(std::string("operation.rotation") + kAxes[i], static_cast<double>(placement.rotation[i]));
  }
}

void add(Expected& out, const GiveObject& g) {
  out.add_unless_zero("operation.object", g.object.packed());
  out.add_unless_zero("operation.owner", g.owner.value);
  out.add_unless_zero("operation.owner_before", g.before.value);
  if (g.placement) add(out, *g.placement);
}

void add(Expected& out, const RequestObject& r) {
  out.add_unless_zero("operation.object", r.object.packed());
  out.add("operation.owner", r.owner.value);
  out.add("operation.by", r.by.value);
}

void add(Expected& out, const RefuseRequest& r) {
  out.add("operation.request.author", r.request.author.value);
  out.add("operation.request.number", r.request.number);
  out.add_text("operation.reason", r.reason);
}

void add(Expected& out, const PlaceObject& p) {
  out.add_unless_zero("operation.object", p.object.packed());
  out.add("operation.owner", p.owner.value);
  out.add_unless_zero("operation.at_ns", p.at.time_since_epoch().count());
  add(out, p.placement);
}

void add(Expected& out, const SetData& d) {
  out.add_unless_zero("operation.node", d.node.packed());
  if (!d.key.empty()) out.add_bytes("operation.key", d.key);
  if (d.value) out.add_bytes("operation.data", *d.value);
}

void add(Expected& out, const SendMessage& m) {
  out.add("operation.by", m.by.value);
  if (!m.topic.empty()) out.add_bytes("operation.topic", m.topic);
  if (!m.text.empty()) out.add_bytes("operation.message", m.text);
}

void add(Expected& out, const UndoOperation& u) {
  out.add("operation.undone.number", u.number);
  out.add_unless_zero("operation.undone.stamp_ns", u.stamp.time_since_epoch().count());
  if (u.redoes) out.add("operation.redoes", 1);
}

void add(Expected& out, const LockObject& l) {
  out.add_unless_zero("operation.object", l.object.packed());
  if (l.unlocks) out.add("operation.unlocks", 1);
}

void add(Expected& out, const SeenOperations::Shown& shown) {
  const Operation& o = shown.operation;
  out.add("operation", 1);
  out.add("operation.kind", kKinds[o.body.index()]);
  out.add("operation.author", o.id.author.value);
  out.add("operation.number", o.id.number);
  out.add_unless_zero("operation.stamp_ns", o.stamp.time_since_epoch().count());
  out.add("operation.from", shown.from);
  out.add("operation.bytes", shown.to - shown.from);
  if (!shown.key.empty()) out.add("operation.author_key", hex(shown.key));
  if (!shown.signature.empty()) out.add("operation.signature", hex(shown.signature));
  if (shown.is_repeated) out.add("operation.repeated", 1);
  for (const OperationId& known : o.knows) {
    out.add("operation.knows.author", known.author.value);
    out.add("operation.knows.number", known.number);
  }
  std::visit([&](const auto& body) { add(out, body); }, o.body);
}

void add_logs(Expected& out, const std::vector<LogLength>& logs) {
  for (const LogLength& log : logs) {
    out.add("log.author", log.author.value);
    out.add("log.bytes", log.bytes);
  }
}

void add(Expected& out, const snapshot::Request& request) {
  out.add_unless_zero("session", request.session);
  if (std::holds_alternative<snapshot::OfferRequest>(request.what)) {
    out.add("kind", "offer request");
  } else if (const auto* part = std::get_if<snapshot::PartRequest>(&request.what)) {
    out.add("kind", "range request");
    out.add_unless_zero("range.author", part->range.author.value);
    out.add_unless_zero("range.from", part->range.from);
    out.add("range.to", part->range.to);
  } else {
    out.add("kind", "digests request");
    add_logs(out, std::get<snapshot::DigestRequest>(request.what).logs);
  }
}

void add(Expected& out, const snapshot::Refusal& refusal) {
  out.add("kind", "refusal");
  if (!refusal.why.empty()) out.add_text("refusal", refusal.why);
}

void add(Expected& out, const snapshot::Offer& offer) {
  out.add("kind", "offer");
  out.add_unless_zero("protocol", offer.protocol);
  out.add_unless_zero("session", offer.session);
  if (!offer.world.empty()) out.add_text("world", offer.world);
  if (!offer.settings.empty()) out.add_text("settings", offer.settings);
  out.add_unless_zero("genesis", offer.genesis);
  out.add_unless_zero("archive.bytes", offer.archive_bytes);
  out.add_unless_zero("archive.digest", offer.archive_digest);
  add_logs(out, offer.logs);
}

void add(Expected& out, const snapshot::Part& part) {
  out.add("kind", "chunk");
  out.add("chunk.bytes", compress(part.bytes).size());
  out.add("chunk.unpacked_bytes", part.bytes.size());
}

void add(Expected& out, const snapshot::Digests& digests) {
  out.add("kind", "digests");
  for (const std::uint64_t digest : digests.digests) out.add("digest", digest);
}

}  // namespace

std::span<const char* const> kinds_of_operations() { return kKinds; }

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    for (const auto digit : {byte >> 4, byte & std::byte{15}}) text += "0123456789abcdef"[std::to_integer<int>(digit)];
  }
  return text;
}

void Expected::add_text(const std::string& name, std::string_view text) {
  std::string shown;
  for (const char c : text) {
    const bool is_plain = c >= ' ' && c <= '~' && c != '\\' && c != '?';
    if (c != '\n' && !is_plain) return add(name, kAnyText);
    shown += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  add(name, shown);
}

void SeenOperations::receive(const OperationPart& part) {
  (void)logs_.receive(part);
  auto& whole = whole_[part.author];
  std::uint64_t at = whole.empty() ? 0 : whole.back().to;
  while (at < logs_.whole(part.author)) {
    const auto next = decode_operation(part.author, logs_.bytes({part.author, at, logs_.whole(part.author)}));
    ASSERT_TRUE(next && *next) << "whole operations that are none";
    const auto bytes = logs_.bytes({part.author, at, at + (*next)->size_bytes});
    const auto as_signed = signed_operation(bytes);
    ASSERT_TRUE(as_signed && *as_signed);
    const auto signature = (*as_signed)->signature;
    whole.push_back(
        {(*next)->operation, at, at + bytes.size(), key_in(**as_signed), {signature.begin(), signature.end()}});
    at = whole.back().to;
  }
}

SeenOperations::Said SeenOperations::take(const OperationPart& part) {
  const bool was_readable = logs_.unreadable(part.author) == nullptr;
  const std::uint64_t had = whole_[part.author].empty() ? 0 : whole_[part.author].back().to;
  Said said;
  auto& first = first_[part.author];
  for (std::size_t i = 0; was_readable && i < part.bytes.size(); ++i) {
    const auto known = first.find(part.from + i);
    said.is_forked |= known != first.end() && known->second != part.bytes[i];
  }
  if (said.is_forked) return said;
  for (std::size_t i = 0; was_readable && i < part.bytes.size(); ++i) first.emplace(part.from + i, part.bytes[i]);
  receive(part);
  said.is_unreadable = was_readable && logs_.unreadable(part.author) != nullptr;
  for (Shown& each : whole_[part.author]) {
    const bool ends_here = each.to > part.from && each.to <= part.from + part.bytes.size();
    if (!ends_here && each.to <= had) continue;
    said.operations.push_back(each);
    each.is_repeated = true;
  }
  return said;
}

Fields Readers::datagram(std::span<const std::byte> datagram, RegionId region, SimTime near) {
  Expected out;
  const auto mark = datagram.empty() ? 0 : std::to_integer<int>(datagram.front());
  const int kind = mark & 0xE0;
  const bool is_announcement = kind == 0xC0 && datagram.size() >= 218;
  const bool is_sealed = kind == 0x80 && datagram.size() >= 24, is_signed = kind == 0xA0 && datagram.size() >= 88;
  if (is_announcement || is_sealed || is_signed) {
    const auto number = [&](std::size_t at, std::size_t size) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < size; ++i) value |= std::to_integer<std::uint32_t>(datagram[at + i]) << (8 * i);
      return value;
    };
    out.add("region", region.value);
    out.add("kind", is_announcement ? "announcement" : is_sealed ? "sealed" : "sealed and signed");
    out.add("seal.epoch", mark % 32);
    out.add("seal.sender", number(1, 4));
    if (!is_announcement) out.add("seal.counter", number(5, 3));
    return out.fields();
  }
  if (mark >= 0xE0 && datagram.size() >= 49) {
    out.add("region", region.value);
    out.add("kind", "part of a roster");
    out.add("seal.epoch", mark % 32);
    return out.fields();
  }
  if (mark == 0x67 && datagram.size() >= 41) {
    out.add("kind", "sealed greeting");
    return out.fields();
  }
  const auto m = decode(datagram, near);
  if (!m) {
    out.add("malformed", "");
    return out.fields();
  }
  out.add("region", region.value);
  out.add("version", kProtocolVersion);
  out.add("sender", m->sender.value);
  if (m->number != 0) out.add("number", m->number);
  if (m->introduction() == nullptr && m->incarnation != 0) out.add("boot_low", m->incarnation);
  if (m->hello) add(out, *m->hello, m->incarnation);
  if (m->nearby) out.add("nearby", 1);
  if (m->next_hello) out.add("next_hello_ms", *m->next_hello / std::chrono::milliseconds(1));
  for (const UpdateRecord& u : m->updates) add(out, u);
  for (const DecisionRecord& d : m->decisions) add(out, d);
  if (!m->scene.states.empty()) {
    out.add("scene.since_ns", m->scene.since);
    for (const UpdateRecord& u : m->scene.states) add(out, u);
  }
  add_ghosts(out, *m);
  for (const Subscription& e : m->subscriptions) {
    out.add("entered.region", e.region.value);
    out.add("entered.since_ns", e.since);
  }
  for (const Handover& g : m->handovers) {
    out.add("gone.object", g.object.packed());
    out.add("gone.sequence", g.sequence);
    out.add("gone.region", g.to.value);
  }
  if (m->identity) {
    out.add_unless_zero("identity.asker", m->identity->asker);
    out.add_unless_zero("identity.world_hash", m->identity->world_hash);
    if (m->identity->answers) out.add("identity.answers", 1);
  }
  for (const OperationPart& part : m->operations) {
    out.add("operations.author", part.author.value);
    out.add("operations.from", part.from);
    out.add("operations.bytes", part.bytes.size());
    const SeenOperations::Said said = operations_[region].take(part);
    for (const SeenOperations::Shown& shown : said.operations) add(out, shown);
    if (said.is_unreadable) out.add("operation.malformed", "");
    if (said.is_forked) out.add("operations.forked", "");
  }
  for (const OperationRange& range : m->operation_requests) {
    out.add("operations.asked.author", range.author.value);
    out.add("operations.asked.from", range.from);
    out.add("operations.asked.bytes", range.to - range.from);
  }
  if (m->leaving) out.add("leaving", true);
  return out.fields();
}

Fields Readers::discovery(std::span<const std::byte> datagram) {
  Expected out;
  if (discovery::is_question(datagram)) {
    out.add("kind", "question");
  } else if (const auto beacon = discovery::decode(datagram)) {
    out.add("kind", "beacon");
    out.add("beacon.protocol", beacon->protocol);
    out.add("beacon.session", beacon->session);
    out.add("beacon.peer", beacon->peer.value);
    out.add("beacon.incarnation", beacon->incarnation);
    out.add("beacon.snapshot_port", beacon->snapshot_port);
    out.add("beacon.sealed", beacon->sealed);
    out.add_text("beacon.world", beacon->world);
    out.add_text("beacon.name", beacon->name);
  } else {
    out.add("malformed", "");
  }
  return out.fields();
}

Fields Readers::segment(const std::string& connection, bool from_client, std::string_view bytes, std::size_t number) {
  constexpr std::size_t kHead_bytes = 4;
  Connection& c = connections_[connection];
  std::string& unread = c.unread[from_client ? 1 : 0];
  unread += bytes;
  Expected out("peerd_join.");
  while (unread.size() >= kHead_bytes) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < kHead_bytes; ++i) {
      size |= static_cast<std::size_t>(static_cast<unsigned char>(unread[i])) << (8 * i);
    }
    if (size > (from_client ? snapshot::kRequestMax_bytes : snapshot::kReplyMax_bytes)) {
      out.add("malformed", "");
      unread.clear();
    }
    if (unread.size() < kHead_bytes + size) break;
    frame(out, c, from_client, unread.substr(kHead_bytes, size), number);
    unread.erase(0, kHead_bytes + size);
  }
  return out.fields();
}

void Readers::frame(Expected& out, Connection& connection, bool from_client, const std::string& frame,
                    std::size_t number) {
  out.add("bytes", frame.size());
  if (from_client) {
    const auto request = snapshot::decode_request(frame);
    if (request) {
      add(out, *request);
    } else {
      out.add("malformed", "");
    }
    const auto* part = request ? std::get_if<snapshot::PartRequest>(&request->what) : nullptr;
    connection.asked.emplace_back(number, part ? part->range : OperationRange{});
    return;
  }
  std::optional<OperationRange> range;
  if (!connection.asked.empty()) {
    out.add("request_in", connection.asked.front().first);
    range = connection.asked.front().second;
    connection.asked.pop_front();
  }
  const auto reply = snapshot::decode_reply(frame);
  if (!reply) return out.add("malformed", "");
  std::visit([&](const auto& what) { add(out, what); }, *reply);
  const auto* part = std::get_if<snapshot::Part>(&*reply);
  if (part == nullptr || !range || range->author == kNoAuthor) return;
  const auto bytes = std::as_bytes(std::span(part->bytes));
  learn({range->author, range->from, Bytes(bytes.begin(), bytes.end())});
}

}  // namespace peerd::sim::dissector_test
