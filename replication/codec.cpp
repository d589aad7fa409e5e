#include "replication/codec.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "proto/peerd.pb.h"
#include "replication/record.hpp"
#include "replication/wire_limits.hpp"

namespace peerd::replication {
namespace {

constexpr std::size_t kUsualRecord_bytes = 24;
constexpr int kListMax = 1024;  // entries; a datagram of kDatagramMax_bytes cannot hold more

// ---- to Protobuf ----

void put(const Vec3& v, proto::Vec3* out) {
  out->set_x(v.x());
  out->set_y(v.y());
  out->set_z(v.z());
}

void put(const Quat& q, proto::Quat* out) {
  out->set_w(q.w());
  out->set_x(q.x());
  out->set_y(q.y());
  out->set_z(q.z());
}

bool is_identity(const Quat& q) { return q.coeffs().isApprox(Quat::Identity().coeffs(), 0.0); }

void put(const KinematicState& s, proto::Kinematics* out) {
  put(s.position, out->mutable_position());
  if (!s.velocity.isZero(0.0)) put(s.velocity, out->mutable_velocity());
  if (!s.acceleration.isZero(0.0)) put(s.acceleration, out->mutable_acceleration());
  if (!is_identity(s.orientation)) put(s.orientation, out->mutable_orientation());
  if (!s.angular_velocity_body.isZero(0.0)) put(s.angular_velocity_body, out->mutable_angular_velocity_body());
}

// All in one field, one behind the other; times count from the first one's.
void put(const std::vector<UpdateRecord>& updates, proto::Datagram* out) {
  if (updates.empty()) return;
  const SimTime base = updates.front().at;
  out->set_base_ns(base.time_since_epoch().count());
  std::string& bytes = *out->mutable_records();
  bytes.reserve(kDatagramMax_bytes);
  std::array<std::byte, kRecordMax_bytes> record;
  for (const UpdateRecord& u : updates) {
    bytes.append(reinterpret_cast<const char*>(record.data()), encode_record(u, base, record));
  }
}

void put(const DecisionRecord& d, proto::Decision* out) {
  out->set_collider(d.collider.value);
  out->set_collidee(d.collidee.value);
  out->set_contact_ns(d.contact.time_since_epoch().count());
  put(d.normal, out->mutable_normal());
  put(d.collider_before, out->mutable_collider_before());
  put(d.collidee_before, out->mutable_collidee_before());
  put(d.collider_after, out->mutable_collider_after());
  put(d.collidee_after, out->mutable_collidee_after());
  out->set_rule(static_cast<std::uint32_t>(d.rule));
  out->set_known_ns(d.known.time_since_epoch().count());
}

void put(const Viewpoint& v, proto::Viewpoint* out) {
  if (v.object) out->set_object(v.object->value);
  put(v.pose.position, out->mutable_position());
  put(v.pose.orientation, out->mutable_orientation());
  out->set_field_of_view(v.field_of_view);
  out->set_aspect(v.aspect);
}

void put(const ContactNote& n, proto::ContactNote* out) {
  out->set_collider(n.collider.value);
  out->set_collidee(n.collidee.value);
  out->set_contact_ns(n.contact.time_since_epoch().count());
  out->set_held(n.held);
  out->set_by(n.by.value);
}

void put(const Hello& h, proto::Hello* out) {
  out->set_name(h.name);
  out->set_world_hash(h.world_hash);
  out->set_host_tx_ns(h.host_tx.time_since_epoch().count());
  out->set_synchronised(h.synchronised);
  out->set_session_minus_host_ns(h.session_minus_host.count());
  out->set_sessions(h.sessions);
  for (const ClockEcho& e : h.echoes) {
    proto::ClockEcho* o = out->add_echoes();
    o->set_peer(e.peer.value);
    o->set_their_tx_ns(e.their_tx.time_since_epoch().count());
    o->set_our_rx_ns(e.our_rx.time_since_epoch().count());
    o->set_loss_permille(static_cast<std::uint32_t>(std::lround(1000.0 * e.loss)));
  }
  for (ObjectId id : h.enslaved) out->add_enslaved(id.value);
  if (h.start) out->set_start_ns(h.start->time_since_epoch().count());
  if (h.world_zero) out->set_world_zero_ns(h.world_zero->time_since_epoch().count());
  out->set_latency_ms(
      static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(h.latency).count()));
  if (h.viewpoint) put(*h.viewpoint, out->mutable_viewpoint());
  for (const ContactNote& n : h.notes) put(n, out->add_notes());
}

// ---- from Protobuf: each take() answers whether the value may be used ----

bool take(const proto::Vec3& in, Vec3& v) {
  v = Vec3(in.x(), in.y(), in.z());
  return acceptable(v);
}

bool take(const proto::Quat& in, Quat& q) {
  q = Quat(in.w(), in.x(), in.y(), in.z());
  return acceptable(q);
}

bool take(const proto::Kinematics& in, KinematicState& s) {
  return take(in.position(), s.position) && take(in.velocity(), s.velocity) &&
         take(in.acceleration(), s.acceleration) && (!in.has_orientation() || take(in.orientation(), s.orientation)) &&
         take(in.angular_velocity_body(), s.angular_velocity_body) && s.angular_velocity_body.norm() <= kSpinMax;
}

template <class Time>
bool take(std::int64_t ns, Time& t) {
  t = Time{Duration{ns}};
  return in_range(ns);
}

// An update of a later version's model is left out; it must not cost the rest of its datagram.
bool take_records(const proto::Datagram& in, Message& m) {
  SimTime base;
  if (!take(in.base_ns(), base)) return false;
  auto rest = std::as_bytes(std::span(in.records()));
  m.updates.reserve(rest.size() / kUsualRecord_bytes);
  while (!rest.empty()) {
    const auto update = decode_record(rest, base);
    if (update) {
      m.updates.push_back(*update);
    } else if (update.error() == RecordError::kUnknownModel) {
      ++m.unknown_models;
    } else {
      return false;
    }
  }
  return true;
}

bool take(const proto::Decision& in, DecisionRecord& d) {
  d.collider = ObjectId{in.collider()};
  d.collidee = ObjectId{in.collidee()};
  if (in.rule() < static_cast<std::uint32_t>(DecisionRule::kId) ||
      in.rule() > static_cast<std::uint32_t>(DecisionRule::kServer)) {
    return false;
  }
  d.rule = static_cast<DecisionRule>(in.rule());
  return take(in.contact_ns(), d.contact) && take(in.known_ns(), d.known) && take(in.normal(), d.normal) &&
         std::abs(d.normal.norm() - 1.0) <= kUnitSlack && take(in.collider_before(), d.collider_before) &&
         take(in.collidee_before(), d.collidee_before) && take(in.collider_after(), d.collider_after) &&
         take(in.collidee_after(), d.collidee_after);
}

bool take(const proto::Viewpoint& in, Viewpoint& v) {
  if (in.has_object()) v.object = ObjectId{in.object()};
  v.field_of_view = in.field_of_view();
  v.aspect = in.aspect();
  return take(in.position(), v.pose.position) && take(in.orientation(), v.pose.orientation) && v.field_of_view > 0.0 &&
         v.field_of_view < std::numbers::pi && v.aspect > 0.0 && v.aspect <= kMagnitudeMax;
}

bool take(const proto::Hello& in, Hello& h) {
  if (!is_name(in.name()) || in.echoes_size() > kListMax || in.enslaved_size() > kListMax) return false;
  h.name = in.name();
  h.world_hash = in.world_hash();
  h.synchronised = in.synchronised();
  h.session_minus_host = Duration{in.session_minus_host_ns()};
  h.sessions = in.sessions();
  if (!take(in.host_tx_ns(), h.host_tx) || !in_range(in.session_minus_host_ns())) return false;
  for (const proto::ClockEcho& e : in.echoes()) {
    ClockEcho echo{PeerId{e.peer()}, {}, {}, 1e-3 * e.loss_permille()};
    if (!take(e.their_tx_ns(), echo.their_tx) || !take(e.our_rx_ns(), echo.our_rx) || echo.loss > 1.0) return false;
    h.echoes.push_back(echo);
  }
  for (std::uint32_t id : in.enslaved()) h.enslaved.push_back(ObjectId{id});
  if (in.has_start_ns() && !take(in.start_ns(), h.start.emplace())) return false;
  if (in.latency_ms() > static_cast<std::uint32_t>(kLatencyMax.count()) || in.notes_size() > kListMax) return false;
  h.latency = std::chrono::milliseconds(in.latency_ms());
  if (in.has_viewpoint() && !take(in.viewpoint(), h.viewpoint.emplace())) return false;
  for (const proto::ContactNote& n : in.notes()) {
    ContactNote note{ObjectId{n.collider()}, ObjectId{n.collidee()}, {}, PeerId{n.by()}, n.held()};
    if (!take(n.contact_ns(), note.contact)) return false;
    h.notes.push_back(note);
  }
  return !in.has_world_zero_ns() || take(in.world_zero_ns(), h.world_zero.emplace());
}

}  // namespace

const char* to_string(DecodeError e) {
  switch (e) {
    case DecodeError::kTooLong:
      return "too_long";
    case DecodeError::kNotADatagram:
      return "not_a_datagram";
    case DecodeError::kVersion:
      return "version";
    case DecodeError::kSender:
      return "sender";
    case DecodeError::kValue:
      return "value";
  }
  return "?";
}

Bytes encode(const Message& m) {
  assert(m.sender.value != 0);
  proto::Datagram d;
  d.set_version(kProtocolVersion);
  d.set_sender(m.sender.value);
  d.set_boot(m.boot);
  d.set_number(m.number);
  if (m.has_hello) put(m.hello, d.mutable_hello());
  put(m.updates, &d);
  for (const DecisionRecord& c : m.decisions) put(c, d.add_decisions());
  d.set_leaving(m.leaving);
  Bytes out(d.ByteSizeLong());
  d.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(out.data()));
  return out;
}

std::expected<Message, DecodeError> decode(std::span<const std::byte> datagram) {
  if (datagram.size() > kDatagramMax_bytes) return std::unexpected(DecodeError::kTooLong);
  proto::Datagram d;
  if (!d.ParseFromArray(datagram.data(), static_cast<int>(datagram.size()))) {
    return std::unexpected(DecodeError::kNotADatagram);
  }
  if (d.version() != kProtocolVersion) return std::unexpected(DecodeError::kVersion);
  if (d.sender() == 0) return std::unexpected(DecodeError::kSender);
  Message m;
  m.sender = PeerId{d.sender()};
  m.boot = d.boot();
  m.number = d.number();
  m.leaving = d.leaving();
  m.has_hello = d.has_hello();
  if (m.has_hello && !take(d.hello(), m.hello)) return std::unexpected(DecodeError::kValue);
  if (!take_records(d, m)) return std::unexpected(DecodeError::kValue);
  for (const proto::Decision& c : d.decisions()) {
    if (!take(c, m.decisions.emplace_back())) return std::unexpected(DecodeError::kValue);
  }
  return m;
}

bool is_name(std::string_view text) {
  const auto visible = [](char c) { return c > ' ' && c < 0x7f && c != '/'; };
  return !text.empty() && text.size() <= kNameMax_bytes && std::ranges::all_of(text, visible);
}

std::size_t encoded_size_bytes(const UpdateRecord& record, SimTime first) {
  std::array<std::byte, kRecordMax_bytes> bytes;
  return encode_record(record, first, bytes);
}

std::size_t encoded_size_bytes(const DecisionRecord& record) {
  proto::Decision decision;
  put(record, &decision);
  const std::size_t body = decision.ByteSizeLong();
  return 1 + (body < 128 ? 1 : 2) + body;  // tag, length varint, body
}

}  // namespace peerd::replication
