#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "proto/peerd.pb.h"
#include "replication/wire/operation.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// ---- to Protobuf ----

void put(const AddNodes& a, proto::Operation* out) {
  proto::AddNodes& add = *out->mutable_add_nodes();
  if (a.parent) add.set_parent(a.parent->packed());
  if (a.before) add.set_before(a.before->packed());
  add.set_text(a.text);
  add.set_first_object(a.first_object);
  add.set_first_node(a.first_node);
  for (const auto& [path, object] : a.names) {
    proto::NamedObject& named = *add.add_names();
    named.set_path(path);
    named.set_object(object.packed());
  }
}

void put(const RemoveObject& r, proto::Operation* out) { out->mutable_remove_object()->set_object(r.object.packed()); }

void put(const RemoveNode& r, proto::Operation* out) { out->mutable_remove_node()->set_node(r.node.packed()); }

void put(const MoveObject& m, proto::Operation* out) {
  proto::MoveObject& move = *out->mutable_move_object();
  move.set_object(m.object.packed());
  if (m.parent) move.set_parent(m.parent->packed());
  if (m.before) move.set_before(m.before->packed());
}

void put(const SetField& s, proto::Operation* out) {
  proto::SetField& set = *out->mutable_set_field();
  set.set_node(s.node.packed());
  set.set_field(s.field);
  set.set_value(s.value);
  set.set_first_node(s.first_node);
}

void put(const ChangeRoute& c, proto::Operation* out) {
  proto::ChangeRoute& route = *out->mutable_change_route();
  route.set_from(c.from.packed());
  route.set_to(c.to.packed());
  route.set_event_out(c.event_out);
  route.set_event_in(c.event_in);
  route.set_removes(c.removes);
}

template <class To>
void put(const Placement& placement, To& out) {
  out.mutable_translation()->Add(placement.translation.begin(), placement.translation.end());
  out.mutable_rotation()->Add(placement.rotation.begin(), placement.rotation.end());
}

void put(const GiveObject& g, proto::Operation* out) {
  proto::GiveObject& give = *out->mutable_give_object();
  give.set_object(g.object.packed());
  give.set_owner(g.owner.value);
  give.set_before(g.before.value);
  if (g.placement) put(*g.placement, give);
}

void put(const PlaceObject& p, proto::Operation* out) {
  proto::PlaceObject& place = *out->mutable_place_object();
  place.set_object(p.object.packed());
  place.set_owner(p.owner.value);
  place.set_at_ns(p.at.time_since_epoch().count());
  put(p.placement, place);
}

void put(const RequestObject& r, proto::Operation* out) {
  proto::RequestObject& request = *out->mutable_request_object();
  request.set_object(r.object.packed());
  request.set_owner(r.owner.value);
  request.set_by(r.by.value);
}

void put(const RefuseRequest& r, proto::Operation* out) {
  proto::RefuseRequest& refuse = *out->mutable_refuse_request();
  refuse.set_author(r.request.author.value);
  refuse.set_number(r.request.number);
  refuse.set_reason(r.reason);
}

void put(const SetData& d, proto::Operation* out) {
  proto::SetData& data = *out->mutable_set_data();
  data.set_node(d.node.packed());
  data.set_key(d.key);
  if (d.value) data.set_value(*d.value);
}

void put(const SendMessage& m, proto::Operation* out) {
  proto::SendMessage& message = *out->mutable_send_message();
  message.set_by(m.by.value);
  message.set_topic(m.topic);
  message.set_text(m.text);
}

void put(const LockObject& l, proto::Operation* out) {
  proto::LockObject& lock = *out->mutable_lock_object();
  lock.set_object(l.object.packed());
  lock.set_unlocks(l.unlocks);
}

void put(const UndoOperation& u, proto::Operation* out) {
  proto::UndoOperation& undo = *out->mutable_undo_operation();
  undo.set_number(u.number);
  undo.set_stamp_ns(u.stamp.time_since_epoch().count());
  undo.set_redoes(u.redoes);
}

// ---- from Protobuf: each take_..() answers null, or what is wrong ----

constexpr const char* kWrongId = "operation_id";
constexpr const char* kWrongText = "operation_text";

bool is_id(std::uint64_t packed) { return packed >> 32 <= kAuthorMax; }

// A text that may go to the reader of VRML: it is not empty and has no byte that ends it early.
bool is_text(const std::string& text) { return !text.empty() && text.find('\0') == std::string::npos; }

template <class Id>
bool take_id(std::uint64_t packed, Id& id) {
  id = Id::unpacked(packed);
  return is_id(packed);
}

template <class Message>
bool take_place(const Message& in, std::optional<ObjectId>& parent, std::optional<ObjectId>& before) {
  return (!in.has_parent() || take_id(in.parent(), parent.emplace())) &&
         (!in.has_before() || take_id(in.before(), before.emplace()));
}

const char* take(proto::AddNodes& in, AddNodes& a) {
  if (!take_place(in, a.parent, a.before)) return kWrongId;
  if (!is_text(in.text())) return kWrongText;
  a.text = std::move(*in.mutable_text());
  a.first_object = in.first_object();
  a.first_node = in.first_node();
  a.names.reserve(static_cast<std::size_t>(in.names_size()));
  for (proto::NamedObject& named : *in.mutable_names()) {
    if (!is_id(named.object())) return kWrongId;
    if (!is_text(named.path())) return kWrongText;
    a.names.emplace_back(std::move(*named.mutable_path()), ObjectId::unpacked(named.object()));
  }
  return nullptr;
}

const char* take(proto::SetField& in, SetField& s) {
  if (!take_id(in.node(), s.node)) return kWrongId;
  if (!is_text(in.field()) || !is_text(in.value())) return kWrongText;
  s.field = std::move(*in.mutable_field());
  s.value = std::move(*in.mutable_value());
  s.first_node = in.first_node();
  return nullptr;
}

const char* take(proto::ChangeRoute& in, ChangeRoute& c) {
  if (!take_id(in.from(), c.from) || !take_id(in.to(), c.to)) return kWrongId;
  if (!is_text(in.event_out()) || !is_text(in.event_in())) return kWrongText;
  c.event_out = std::move(*in.mutable_event_out());
  c.event_in = std::move(*in.mutable_event_in());
  c.removes = in.removes();
  return nullptr;
}

template <std::size_t kCount>
bool take_numbers(const google::protobuf::RepeatedField<float>& in, std::array<float, kCount>& out) {
  if (in.size() != kCount || !std::ranges::all_of(in, [](float x) { return std::isfinite(x); })) return false;
  std::ranges::copy(in, out.begin());
  return true;
}

template <class From>
const char* take(const From& in, Placement& placement) {
  const bool good =
      take_numbers(in.translation(), placement.translation) && take_numbers(in.rotation(), placement.rotation);
  return good ? nullptr : "operation_placement";
}

const char* take(const proto::GiveObject& in, GiveObject& g) {
  g.owner = PeerId{in.owner()};
  g.before = PeerId{in.before()};
  if (!take_id(in.object(), g.object)) return kWrongId;
  if (in.translation().empty() && in.rotation().empty()) return nullptr;
  return take(in, g.placement.emplace());
}

const char* take(const proto::PlaceObject& in, PlaceObject& p) {
  p.owner = PeerId{in.owner()};
  if (!in_range(in.at_ns())) return "operation_stamp";
  p.at = SimTime{Duration{in.at_ns()}};
  if (!take_id(in.object(), p.object) || p.owner == kNobody) return kWrongId;
  return take(in, p.placement);
}

const char* take(const proto::RequestObject& in, RequestObject& r) {
  r.owner = PeerId{in.owner()};
  r.by = PeerId{in.by()};
  const bool good = take_id(in.object(), r.object) && r.owner != kNobody && r.by != kNobody;
  return good ? nullptr : kWrongId;
}

const char* take(proto::RefuseRequest& in, RefuseRequest& r) {
  r.request = {AuthorId{in.author()}, in.number()};
  if (in.author() == 0 || in.author() > kAuthorMax || in.number() == 0) return kWrongId;
  if (!is_text(in.reason())) return kWrongText;
  r.reason = std::move(*in.mutable_reason());
  return nullptr;
}

const char* take(proto::SetData& in, SetData& d) {
  if (!take_id(in.node(), d.node)) return kWrongId;
  d.key = std::move(*in.mutable_key());
  if (in.has_value()) d.value = std::move(*in.mutable_value());
  return nullptr;
}

const char* take(proto::SendMessage& in, SendMessage& m) {
  m.by = PeerId{in.by()};
  if (m.by == kNobody) return kWrongId;
  m.topic = std::move(*in.mutable_topic());
  m.text = std::move(*in.mutable_text());
  return nullptr;
}

const char* take(const proto::UndoOperation& in, UndoOperation& u) {
  u.number = in.number();
  if (u.number == 0) return kWrongId;
  if (!in_range(in.stamp_ns())) return "operation_stamp";
  u.stamp = SimTime{Duration{in.stamp_ns()}};
  u.redoes = in.redoes();
  return nullptr;
}

// Pairs of an author, less the one before, and a number.
const char* take_knows(const proto::Operation& in, std::vector<OperationId>& knows) {
  if (in.knows_author_size() != in.knows_number_size() || in.knows_author_size() > static_cast<int>(kKnowsMax)) {
    return kWrongId;
  }
  std::uint32_t last = 0;
  for (int i = 0; i < in.knows_author_size(); ++i) {
    const std::uint32_t more = in.knows_author(i), number = in.knows_number(i);
    if (more == 0 || more > kAuthorMax - last || number == 0) return kWrongId;
    last += more;
    knows.push_back({AuthorId{last}, number});
  }
  return nullptr;
}

const char* take(proto::Operation& in, OperationBody& body) {
  switch (in.body_case()) {
    case proto::Operation::kAddNodes:
      return take(*in.mutable_add_nodes(), body.emplace<AddNodes>());
    case proto::Operation::kRemoveObject:
      return take_id(in.remove_object().object(), body.emplace<RemoveObject>().object) ? nullptr : kWrongId;
    case proto::Operation::kRemoveNode:
      return take_id(in.remove_node().node(), body.emplace<RemoveNode>().node) ? nullptr : kWrongId;
    case proto::Operation::kMoveObject: {
      MoveObject& move = body.emplace<MoveObject>();
      const bool good =
          take_id(in.move_object().object(), move.object) && take_place(in.move_object(), move.parent, move.before);
      return good ? nullptr : kWrongId;
    }
    case proto::Operation::kSetField:
      return take(*in.mutable_set_field(), body.emplace<SetField>());
    case proto::Operation::kChangeRoute:
      return take(*in.mutable_change_route(), body.emplace<ChangeRoute>());
    case proto::Operation::kGiveObject:
      return take(in.give_object(), body.emplace<GiveObject>());
    case proto::Operation::kRequestObject:
      return take(in.request_object(), body.emplace<RequestObject>());
    case proto::Operation::kRefuseRequest:
      return take(*in.mutable_refuse_request(), body.emplace<RefuseRequest>());
    case proto::Operation::kSetData:
      return take(*in.mutable_set_data(), body.emplace<SetData>());
    case proto::Operation::kSendMessage:
      return take(*in.mutable_send_message(), body.emplace<SendMessage>());
    case proto::Operation::kUndoOperation:
      return take(in.undo_operation(), body.emplace<UndoOperation>());
    case proto::Operation::kPlaceObject:
      return take(in.place_object(), body.emplace<PlaceObject>());
    case proto::Operation::kLockObject: {
      LockObject& lock = body.emplace<LockObject>();
      lock.unlocks = in.lock_object().unlocks();
      return take_id(in.lock_object().object(), lock.object) ? nullptr : kWrongId;
    }
    case proto::Operation::BODY_NOT_SET:
      break;
  }
  return "operation_kind";  // none, or a later version's
}

// ---- the size in front of it ----

constexpr std::size_t kSizeMax_bytes = 3;
static_assert(kOperationMax_bytes < std::size_t{1} << (7 * kSizeMax_bytes), "a varint of three bytes holds any size");

// The size that these bytes begin with, and how many bytes state it (0: they end within it).
std::expected<std::pair<std::size_t, std::size_t>, const char*> size_of_first(std::span<const std::byte> log) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < kSizeMax_bytes; ++i) {
    if (i == log.size()) return std::pair(std::size_t{0}, std::size_t{0});
    const auto group = std::to_integer<std::size_t>(log[i]);
    size |= (group & 127) << (7 * i);
    if (group >= 128) continue;
    if (i > 0 && group == 0) return std::unexpected("operation_size");  // not the shortest form
    if (size > kOperationMax_bytes) return std::unexpected("operation_too_large");
    return std::pair(size, i + 1);
  }
  return std::unexpected("operation_too_large");
}

// The tag and the length of the field `signature`.
constexpr std::array kSignatureTag{std::byte{0xA2}, std::byte{0x06}, std::byte{kSignature_bytes}};
static_assert(kSignature_bytes < 128 && proto::Operation::kSignatureFieldNumber == 100);

proto::Operation to_message(const Operation& operation) {
  assert(operation.id.number != 0 && in_range(operation.stamp.time_since_epoch().count()));
  proto::Operation message;
  message.set_number(operation.id.number);
  message.set_stamp_ns(operation.stamp.time_since_epoch().count());
  std::visit([&](const auto& body) { put(body, &message); }, operation.body);
  std::uint32_t last = 0;
  for (const auto& [author, number] : operation.knows) {
    assert(author.value > last && number > 0);
    message.add_knows_author(author.value - last);
    message.add_knows_number(number);
    last = author.value;
  }
  return message;
}

std::vector<std::byte> to_bytes(const proto::Operation& message) {
  const std::size_t size = message.ByteSizeLong();
  assert(size <= static_cast<std::size_t>(std::numeric_limits<int>::max()));
  std::vector<std::byte> bytes;
  bytes.reserve(size + kSizeMax_bytes);
  std::size_t left = size;
  for (; left >= 128; left >>= 7) bytes.push_back(static_cast<std::byte>((left & 127) | 128));
  bytes.push_back(static_cast<std::byte>(left));
  const std::size_t begin = bytes.size();
  bytes.resize(begin + size);
  message.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(bytes.data() + begin));
  return bytes;
}

}  // namespace

const char* kind_of(const OperationBody& body) {
  constexpr std::array kKinds{"add",     "remove", "remove", "move", "set",  "route", "give",
                              "request", "refuse", "data",   "send", "undo", "place", "lock"};
  static_assert(kKinds.size() == std::variant_size_v<OperationBody>);
  const auto* const undo = std::get_if<UndoOperation>(&body);
  if (undo != nullptr && undo->redoes) return "redo";
  const auto* const lock = std::get_if<LockObject>(&body);
  return lock != nullptr && lock->unlocks ? "unlock" : kKinds[body.index()];
}

std::vector<std::byte> encode(const Operation& operation) { return to_bytes(to_message(operation)); }

std::vector<std::byte> encode_unsigned(const Operation& operation, std::span<const std::byte> key) {
  proto::Operation message = to_message(operation);
  if (!key.empty()) message.set_key(key.data(), key.size());
  message.set_signature(std::string(kSignature_bytes, '\0'));
  return to_bytes(message);
}

std::expected<std::optional<SignedOperation>, const char*> signed_operation(std::span<const std::byte> log) {
  const auto first = size_of_first(log);
  if (!first) return std::unexpected(first.error());
  const auto [size, begin] = *first;
  if (begin == 0 || log.size() - begin < size) return std::nullopt;
  SignedOperation operation{log.first(begin + size), {}, {}};
  constexpr std::size_t kField_bytes = kSignatureTag.size() + kSignature_bytes;
  if (size < kField_bytes) return operation;
  const auto field = operation.entry.last(kField_bytes);
  if (!std::ranges::equal(field.first(kSignatureTag.size()), kSignatureTag)) return operation;
  operation.is_signed = operation.entry.first(operation.entry.size() - kField_bytes);
  operation.signature = field.last(kSignature_bytes);
  return operation;
}

std::vector<std::byte> key_in(const SignedOperation& operation) {
  const auto first = size_of_first(operation.entry);
  assert(first);  // it has been read
  const auto bytes = operation.entry.subspan(first->second);
  proto::Operation message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return {};
  const auto key = std::as_bytes(std::span(message.key()));
  return {key.begin(), key.end()};
}

std::expected<std::optional<DecodedOperation>, const char*> decode_operation(AuthorId author,
                                                                             std::span<const std::byte> log) {
  assert(author != kNoAuthor && author.value <= kAuthorMax);
  const auto first = size_of_first(log);
  if (!first) return std::unexpected(first.error());
  const auto [size, begin] = *first;
  if (begin == 0 || log.size() - begin < size) return std::nullopt;
  proto::Operation message;
  if (!message.ParseFromArray(log.data() + begin, static_cast<int>(size))) return std::unexpected("not_an_operation");
  if (message.number() == 0) return std::unexpected("operation_number");
  if (!in_range(message.stamp_ns())) return std::unexpected("operation_stamp");
  DecodedOperation decoded;
  decoded.size_bytes = begin + size;
  decoded.operation.id = {author, message.number()};
  decoded.operation.stamp = SimTime{Duration{message.stamp_ns()}};
  if (const char* wrong = take(message, decoded.operation.body)) return std::unexpected(wrong);
  if (const char* wrong = take_knows(message, decoded.operation.knows)) return std::unexpected(wrong);
  return decoded;
}

std::size_t operation_size_bytes(std::span<const std::byte> log) {
  const auto first = size_of_first(log);
  assert(first && first->second > 0 && first->first + first->second <= log.size());
  return first->first + first->second;
}

}  // namespace peerd::replication
