#include "replication/codec.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "proto/peerd.pb.h"

namespace peerd::replication {
namespace {

// Farther or faster than this is not a world of metres and seconds but a damaged datagram; squares of it stay finite.
constexpr double kMagnitudeMax = 1e12;
// 1,600 turns a second. Faster ones only make contact searches long: their steps are as short as the spin is fast.
constexpr double kSpinMax = 1e4;  // [rad/s]
// Quaternions and normals are sent as doubles; what is this far off unit length was not sent by us.
constexpr double kUnitSlack = 1e-6;
// A year on either side of any epoch a clock counts from would do; this keeps differences of two stamps within int64.
constexpr std::int64_t kTimeMax_ns = std::int64_t{1} << 62;
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

void put(const UpdateRecord& u, proto::Update* out) {
  out->set_object(u.object.value);
  out->set_sequence(u.sequence);
  out->set_session_ns(u.at.time_since_epoch().count());
  out->set_model(static_cast<std::uint32_t>(u.model.kind));
  put(u.model.state, out->mutable_state());
  if (!u.model.jerk.isZero(0.0)) put(u.model.jerk, out->mutable_jerk());
  if (!u.model.rate_rad_s.isZero(0.0)) put(u.model.rate_rad_s, out->mutable_rate());
  if (!u.model.angular_acceleration_body.isZero(0.0)) {
    put(u.model.angular_acceleration_body, out->mutable_angular_acceleration_body());
  }
  out->set_decision_ns(u.decision.time_since_epoch().count());
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
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMagnitudeMax;
}

bool take(const proto::Quat& in, Quat& q) {
  q = Quat(in.w(), in.x(), in.y(), in.z());
  if (!q.coeffs().allFinite() || std::abs(q.norm() - 1.0) > kUnitSlack) return false;
  return true;
}

bool take(const proto::Kinematics& in, KinematicState& s) {
  return take(in.position(), s.position) && take(in.velocity(), s.velocity) &&
         take(in.acceleration(), s.acceleration) && (!in.has_orientation() || take(in.orientation(), s.orientation)) &&
         take(in.angular_velocity_body(), s.angular_velocity_body) && s.angular_velocity_body.norm() <= kSpinMax;
}

bool in_range(std::int64_t ns) { return ns >= -kTimeMax_ns && ns <= kTimeMax_ns; }

template <class Time>
bool take(std::int64_t ns, Time& t) {
  t = Time{Duration{ns}};
  return in_range(ns);
}

bool knows(std::uint32_t model) {
  return std::ranges::any_of(kMotionKinds, [&](MotionKind kind) { return static_cast<std::uint32_t>(kind) == model; });
}

bool take(const proto::Update& in, UpdateRecord& u) {
  u.object = ObjectId{in.object()};
  u.sequence = in.sequence();
  if (u.sequence == 0 || !take(in.session_ns(), u.at) || !take(in.decision_ns(), u.decision)) return false;
  MotionModel& m = u.model;
  m.kind = static_cast<MotionKind>(in.model());
  return take(in.state(), m.state) && take(in.jerk(), m.jerk) && take(in.rate(), m.rate_rad_s) &&
         take(in.angular_acceleration_body(), m.angular_acceleration_body) && within_limits(m);
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

template <class Record, class Proto>
std::size_t framed_size_bytes(const Record& record) {
  Proto p;
  put(record, &p);
  const std::size_t body = p.ByteSizeLong();
  return 1 + (body < 128 ? 1 : 2) + body;  // tag, length varint, body
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
  for (const UpdateRecord& u : m.updates) put(u, d.add_updates());
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
  for (const proto::Update& u : d.updates()) {
    if (u.model() != 0 && !knows(u.model())) {
      ++m.unknown_models;
      continue;
    }
    if (!knows(u.model()) || !take(u, m.updates.emplace_back())) return std::unexpected(DecodeError::kValue);
  }
  for (const proto::Decision& c : d.decisions()) {
    if (!take(c, m.decisions.emplace_back())) return std::unexpected(DecodeError::kValue);
  }
  return m;
}

bool is_name(std::string_view text) {
  const auto visible = [](char c) { return c > ' ' && c < 0x7f && c != '/'; };
  return !text.empty() && text.size() <= kNameMax_bytes && std::ranges::all_of(text, visible);
}

std::size_t encoded_size_bytes(const UpdateRecord& record) {
  return framed_size_bytes<UpdateRecord, proto::Update>(record);
}
std::size_t encoded_size_bytes(const DecisionRecord& record) {
  return framed_size_bytes<DecisionRecord, proto::Decision>(record);
}

}  // namespace peerd::replication
