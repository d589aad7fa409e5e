#include "replication/wire/codec.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "proto/peerd.pb.h"
#include "replication/wire/decision_bits.hpp"
#include "replication/wire/ghost_lists.hpp"
#include "replication/wire/hello_lists.hpp"
#include "replication/wire/operation_lists.hpp"
#include "replication/wire/varint.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

constexpr std::size_t kUsualRecord_bytes = 24;
constexpr int kListMax = 1024;  // entries; a datagram of kDatagramMax_bytes cannot hold more
constexpr int kBase_bytes = kLowTime_bits / 8;
static_assert(8 * kBase_bytes == kLowTime_bits);
constexpr int kTime_bytes = 8;
// Version, sender, number and incarnation, each a varint with its tag.
constexpr std::size_t kHeaderMax_bytes = 20;
static_assert(kHeaderMax_bytes + kOperationListHeader_bytes + kOperationsMax_bytes <= kDatagramMax_bytes);
static_assert(kListMax >= 2 * static_cast<int>(kSubscriptionsMax));

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

// All updates go in one field, one behind the other; times count from the first one's, whose low bytes come first.
void put(std::span<const EncodedUpdate> updates, proto::Datagram* out) {
  if (updates.empty()) return;
  std::string& bytes = *out->mutable_records();
  bytes.reserve(kDatagramMax_bytes);
  std::uint64_t low = low_time(updates.front().record().at);
  for (int i = 0; i < kBase_bytes; ++i, low >>= 8) bytes.push_back(static_cast<char>(low & 0xFF));
  for (const EncodedUpdate& u : updates) {
    bytes.append(reinterpret_cast<const char*>(u.bytes().data()), u.bytes().size());
  }
}

void append_time(SimTime t, std::string& bytes) {
  auto ns = static_cast<std::uint64_t>(t.time_since_epoch().count());
  for (int i = 0; i < kTime_bytes; ++i, ns >>= 8) bytes.push_back(static_cast<char>(ns & 0xFF));
}

// States may be of any age, so that no time is cut.
void put(const SceneStates& scene, proto::Datagram* out) {
  if (scene.states.empty()) return;
  std::string& bytes = *out->mutable_scene();
  const SimTime base = scene.states.front().at;
  append_time(scene.since, bytes);
  append_time(base, bytes);
  std::array<std::byte, kRecordMax_bytes> record;
  for (const UpdateRecord& state : scene.states) {
    bytes.append(reinterpret_cast<const char*>(record.data()), encode_record(state, base, record));
  }
}

void put(const std::vector<DecisionRecord>& decisions, proto::Datagram* out) {
  std::array<std::byte, kDecisionMax_bytes> bytes;
  for (const DecisionRecord& d : decisions) {
    out->mutable_decisions()->append(reinterpret_cast<const char*>(bytes.data()), encode_decision(d, bytes));
  }
}

void put(const Viewpoint& v, proto::Viewpoint* out) {
  if (v.object) out->set_object(v.object->packed());
  put(v.pose.position, out->mutable_position());
  put(v.pose.orientation, out->mutable_orientation());
  out->set_field_of_view(v.field_of_view);
  out->set_aspect(v.aspect);
}

void put(const Introduction& i, std::uint64_t incarnation, proto::Introduction* out) {
  out->set_name(i.name);
  out->set_world_hash(i.world_hash);
  out->set_incarnation(incarnation);
  out->set_owned(packed(i.owned));
  out->set_owned_as_founder(i.owned_as_founder);
  if (i.start) out->set_start_ns(i.start->time_since_epoch().count());
  if (i.world_zero) out->set_world_zero_ns(i.world_zero->time_since_epoch().count());
  if (i.viewpoint) put(*i.viewpoint, out->mutable_viewpoint());
  out->set_line(i.line);
  out->set_has_edits(i.has_edits);
}

std::uint64_t whole_us(Duration d) {
  return static_cast<std::uint64_t>(std::chrono::ceil<std::chrono::microseconds>(d).count());
}

void put(const Hello& h, std::uint64_t incarnation, proto::Hello* out) {
  if (h.session_tx) out->set_session_tx_ns(h.session_tx->time_since_epoch().count());
  if (h.clock_error) out->set_clock_error_us(whole_us(*h.clock_error));
  if (h.os_clock) {
    out->set_os_minus_session_ns(h.os_clock->minus_session.count());
    out->set_os_error_us(whole_us(h.os_clock->error));
  }
  out->set_sessions(h.sessions);
  out->set_latency_ms(
      static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(h.latency).count()));
  out->set_echoes(packed(h.echoes));
  out->set_notes(packed(h.notes, h.session_tx.value_or(SimTime{})));
  out->set_scene_digest(h.scene_digest);
  out->set_logs(packed(h.logs));
  if (h.introduction) put(*h.introduction, incarnation, out->mutable_introduction());
}

void put(const std::vector<Subscription>& subscriptions, proto::Datagram* out) {
  if (subscriptions.empty()) return;
  const SimTime latest = std::ranges::max(subscriptions, {}, &Subscription::since).since;
  out->set_subscriptions_ns(latest.time_since_epoch().count());
  for (const Subscription& e : subscriptions) {
    out->add_subscriptions(e.region.value);
    out->add_subscriptions(static_cast<std::uint32_t>((latest - e.since) / std::chrono::milliseconds(1)));
  }
}

void put(const std::vector<Handover>& handovers, proto::Datagram* out) {
  for (const Handover& g : handovers) {
    out->add_handovers(g.object.packed());
    out->add_handovers(g.sequence);
    out->add_handovers(g.to.value);
  }
}

// The states are all of one instant.
void put(const GhostAnswer& answer, proto::Datagram* out) {
  if (answer.states.empty()) return;
  std::string& bytes = *out->mutable_ghost_answer();
  const SimTime at = answer.states.front().at;
  append_time(at, bytes);
  std::array<std::byte, kRecordMax_bytes> record;
  for (const UpdateRecord& state : answer.states) {
    assert(state.at == at);
    bytes.append(reinterpret_cast<const char*>(record.data()), encode_record(state, at, record));
  }
}

// Clears the parts that decode() does not set anyway; lists keep their memory.
void clear(Message& m) {
  m.hello.reset();
  m.updates.clear();
  m.decisions.clear();
  m.subscriptions.clear();
  m.handovers.clear();
  m.scene.states.clear();
  m.scene.since = SimTime{};
  m.operations.clear();
  m.operation_requests.clear();
  m.identity.reset();
  m.ghosts.reset();
  m.ghost_question.reset();
  m.ghost_answer.states.clear();
  m.ghost_reports.clear();
  m.unknown_models = 0;
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

bool take(std::int64_t ns, SimTime& t) {
  t = SimTime{Duration{ns}};
  return in_range(ns);
}

bool take_base(std::span<const std::byte, kBase_bytes> bytes, SimTime near, SimTime& base) {
  std::uint64_t low = 0;
  for (int i = kBase_bytes - 1; i >= 0; --i) low = low << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  return take_low_time(low, near, base);
}

// An update of a later version's model is left out; it must not cost the rest of its datagram.
bool take_each(std::span<const std::byte> rest, SimTime base, std::vector<UpdateRecord>& updates,
               std::uint32_t& unknown_models) {
  updates.reserve(rest.size() / kUsualRecord_bytes);
  while (!rest.empty()) {
    const auto update = decode_record(rest, base);
    if (update) {
      updates.push_back(*update);
    } else if (update.error() == RecordError::kUnknownModel) {
      ++unknown_models;
    } else {
      return false;
    }
  }
  return true;
}

bool take_records(const proto::Datagram& in, SimTime near, Message& m) {
  const auto bytes = std::as_bytes(std::span(in.records()));
  if (bytes.empty()) return true;
  SimTime base;
  if (bytes.size() <= kBase_bytes || !take_base(bytes.first<kBase_bytes>(), near, base)) return false;
  return take_each(bytes.subspan(kBase_bytes), base, m.updates, m.unknown_models);
}

bool take_whole_time(std::span<const std::byte, kTime_bytes> bytes, SimTime& t) {
  std::uint64_t ns = 0;
  for (int i = kTime_bytes - 1; i >= 0; --i) ns = ns << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  return take(static_cast<std::int64_t>(ns), t);
}

bool take_scene(const proto::Datagram& in, Message& m) {
  const auto bytes = std::as_bytes(std::span(in.scene()));
  if (bytes.empty()) return true;
  SimTime base;
  if (bytes.size() <= 2 * kTime_bytes || !take_whole_time(bytes.first<kTime_bytes>(), m.scene.since) ||
      !take_whole_time(bytes.subspan<kTime_bytes, kTime_bytes>(), base)) {
    return false;
  }
  if (!take_each(bytes.subspan(2 * kTime_bytes), base, m.scene.states, m.unknown_models)) return false;
  if (m.scene.states.empty()) m.scene.since = SimTime{};
  return std::ranges::none_of(m.scene.states, [](const UpdateRecord& u) { return u.position_step_log2.has_value(); });
}

bool take_ghost_checks(const proto::Datagram& in, SimTime near, Message& m) {
  if (!in.ghost_digest().empty() && !take_ghosts(in.ghost_digest(), near, m.ghosts.emplace())) return false;
  if (!in.ghost_question().empty() && !take_ghosts(in.ghost_question(), near, m.ghost_question.emplace())) return false;
  if (!take_ghosts(in.ghost_reports(), m.ghost_reports)) return false;
  const auto bytes = std::as_bytes(std::span(in.ghost_answer()));
  if (bytes.empty()) return true;
  SimTime at;
  if (bytes.size() <= kTime_bytes || !take_whole_time(bytes.first<kTime_bytes>(), at)) return false;
  std::vector<UpdateRecord>& states = m.ghost_answer.states;
  if (!take_each(bytes.subspan(kTime_bytes), at, states, m.unknown_models) || states.size() > kGhostAnswerMax) {
    return false;
  }
  return std::ranges::all_of(states,
                             [&](const UpdateRecord& u) { return u.at == at && !u.position_step_log2.has_value(); });
}

bool take_subscriptions(const proto::Datagram& in, std::vector<Subscription>& subscriptions) {
  SimTime latest;
  if (in.subscriptions_size() % 2 != 0 || in.subscriptions_size() > kListMax || !take(in.subscriptions_ns(), latest))
    return false;
  for (int i = 0; i < in.subscriptions_size(); i += 2) {
    const SimTime since = latest - std::chrono::milliseconds(in.subscriptions(i + 1));
    if (!in_range(since.time_since_epoch().count())) return false;
    subscriptions.push_back({RegionId{in.subscriptions(i)}, since});
  }
  return true;
}

bool take_handovers(const proto::Datagram& in, std::vector<Handover>& handovers) {
  if (in.handovers_size() % 3 != 0 || in.handovers_size() > kListMax) return false;
  for (int i = 0; i < in.handovers_size(); i += 3) {
    const std::uint64_t sequence = in.handovers(i + 1), to = in.handovers(i + 2);
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (sequence == 0 || sequence > kMost || to > kMost) return false;
    handovers.push_back({ObjectId::unpacked(in.handovers(i)), static_cast<std::uint32_t>(sequence),
                         RegionId{static_cast<std::uint32_t>(to)}});
  }
  return true;
}

bool take_decisions(const proto::Datagram& in, SimTime near, std::vector<DecisionRecord>& decisions) {
  for (auto rest = std::as_bytes(std::span(in.decisions())); !rest.empty();) {
    const auto decision = decode_decision(rest, near);
    if (!decision) return false;
    decisions.push_back(*decision);
  }
  return true;
}

bool take(const proto::Viewpoint& in, Viewpoint& v) {
  if (in.has_object()) v.object = ObjectId::unpacked(in.object());
  v.field_of_view = in.field_of_view();
  v.aspect = in.aspect();
  return take(in.position(), v.pose.position) && take(in.orientation(), v.pose.orientation) && v.field_of_view > 0.0 &&
         v.field_of_view < std::numbers::pi && v.aspect > 0.0 && v.aspect <= kMagnitudeMax;
}

bool take(const proto::Introduction& in, Introduction& i) {
  if (!is_name(in.name()) || !take_objects(in.owned(), i.owned)) return false;
  i.name = in.name();
  i.world_hash = in.world_hash();
  i.owned_as_founder = in.owned_as_founder();
  i.line = in.line();
  i.has_edits = in.has_edits();
  if (in.has_start_ns() && !take(in.start_ns(), i.start.emplace())) return false;
  if (in.has_world_zero_ns() && !take(in.world_zero_ns(), i.world_zero.emplace())) return false;
  return !in.has_viewpoint() || take(in.viewpoint(), i.viewpoint.emplace());
}

bool take_us(std::uint64_t us, Duration most, Duration& d) {
  if (us > whole_us(most)) return false;
  d = std::chrono::microseconds(us);
  return true;
}

bool take(const proto::Hello& in, Hello& h) {
  if (in.has_session_tx_ns() && !take(in.session_tx_ns(), h.session_tx.emplace())) return false;
  if (in.has_clock_error_us() && !take_us(in.clock_error_us(), kClockErrorMax, h.clock_error.emplace())) return false;
  if (in.has_os_error_us()) {
    OsClockNote& os = h.os_clock.emplace();
    os.minus_session = Duration{in.os_minus_session_ns()};
    if (!in_range(in.os_minus_session_ns()) || !take_us(in.os_error_us(), kOsErrorMax, os.error)) {
      return false;
    }
  }
  if (in.latency_ms() > static_cast<std::uint32_t>(kLatencyMax.count())) return false;
  h.sessions = in.sessions();
  h.scene_digest = in.scene_digest();
  h.latency = std::chrono::milliseconds(in.latency_ms());
  return take_echoes(in.echoes(), h.echoes) && take_notes(in.notes(), h.session_tx.value_or(SimTime{}), h.notes) &&
         take_logs(in.logs(), h.logs) && (!in.has_introduction() || take(in.introduction(), h.introduction.emplace()));
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

Codec::Codec() : datagram_(std::make_unique<proto::Datagram>()) {}
Codec::~Codec() = default;

void Codec::encode(const Message& m, std::span<const EncodedUpdate> updates, Bytes& datagram) {
  assert(m.sender.value != 0);
  proto::Datagram& d = *datagram_;
  d.Clear();
  d.set_version(kProtocolVersion);
  d.set_sender(m.sender.value);
  d.set_number(m.number);
  if (m.introduction() == nullptr) d.set_incarnation_low(static_cast<std::uint32_t>(incarnation_low(m.incarnation)));
  if (m.hello) put(*m.hello, m.incarnation, d.mutable_hello());
  put(updates, &d);
  put(m.decisions, &d);
  put(m.subscriptions, &d);
  put(m.handovers, &d);
  put(m.scene, &d);
  d.set_operations(packed(m.operations));
  d.set_operation_requests(packed(m.operation_requests));
  d.set_leaving(m.leaving);
  d.set_nearby(m.nearby);
  if (m.next_hello) {
    d.set_next_hello_ms(
        static_cast<std::uint32_t>(std::chrono::ceil<std::chrono::milliseconds>(*m.next_hello).count()));
  }
  if (m.ghosts) d.set_ghost_digest(packed(*m.ghosts));
  if (m.ghost_question) d.set_ghost_question(packed(*m.ghost_question));
  put(m.ghost_answer, &d);
  if (!m.ghost_reports.empty()) d.set_ghost_reports(packed(m.ghost_reports));
  if (m.identity) {
    d.mutable_identity()->set_asker(m.identity->asker);
    d.mutable_identity()->set_world_hash(m.identity->world_hash);
    d.mutable_identity()->set_answers(m.identity->answers);
  }
  datagram.resize(d.ByteSizeLong());
  d.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(datagram.data()));
}

std::expected<Message*, DecodeError> Codec::decode(std::span<const std::byte> datagram, SimTime near) {
  if (datagram.size() > kDatagramMax_bytes) return std::unexpected(DecodeError::kTooLong);
  proto::Datagram& d = *datagram_;
  if (!d.ParseFromArray(datagram.data(), static_cast<int>(datagram.size()))) {
    return std::unexpected(DecodeError::kNotADatagram);
  }
  if (d.version() != kProtocolVersion) return std::unexpected(DecodeError::kVersion);
  if (d.sender() == 0) return std::unexpected(DecodeError::kSender);
  Message& m = decoded_;
  clear(m);
  m.sender = PeerId{d.sender()};
  m.number = d.number();
  m.leaving = d.leaving();
  m.nearby = d.nearby();
  m.next_hello.reset();
  if (d.next_hello_ms() > kNextHelloMax.count()) return std::unexpected(DecodeError::kValue);
  if (d.next_hello_ms() > 0) m.next_hello = std::chrono::milliseconds(d.next_hello_ms());
  if (d.has_identity()) {
    m.identity = IdentityCheck{d.identity().asker(), d.identity().world_hash(), d.identity().answers()};
  }
  if (d.has_hello() && !take(d.hello(), m.hello.emplace())) return std::unexpected(DecodeError::kValue);
  m.incarnation =
      m.introduction() != nullptr ? d.hello().introduction().incarnation() : incarnation_low(d.incarnation_low());
  if (!take_records(d, near, m)) return std::unexpected(DecodeError::kValue);
  if (!take_scene(d, m) || !take_ghost_checks(d, near, m)) return std::unexpected(DecodeError::kValue);
  if (!take_decisions(d, near, m.decisions)) return std::unexpected(DecodeError::kValue);
  if (!take_subscriptions(d, m.subscriptions) || !take_handovers(d, m.handovers))
    return std::unexpected(DecodeError::kValue);
  if (!take_parts(d.operations(), m.operations) || !take_ranges(d.operation_requests(), m.operation_requests)) {
    return std::unexpected(DecodeError::kValue);
  }
  return &m;
}

std::uint32_t Codec::version() const { return datagram_->version(); }
PeerId Codec::sender() const { return PeerId{datagram_->sender()}; }

Bytes encode(const Message& m) {
  std::vector<EncodedUpdate> updates;
  for (const UpdateRecord& u : m.updates) updates.emplace_back(u, m.updates.front().at);
  Bytes datagram;
  Codec().encode(m, updates, datagram);
  return datagram;
}

std::expected<Message, DecodeError> decode(std::span<const std::byte> datagram, SimTime near) {
  Codec codec;
  const auto message = codec.decode(datagram, near);
  if (!message) return std::unexpected(message.error());
  return std::move(**message);
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
  std::array<std::byte, kDecisionMax_bytes> bytes;
  return encode_decision(record, bytes);
}

}  // namespace peerd::replication
