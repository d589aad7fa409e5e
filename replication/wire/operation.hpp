#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/ids.hpp"
#include "core/strong.hpp"
#include "core/time.hpp"
#include "core/transform.hpp"

namespace peerd::replication {

// An operation is a durable change of the scene, of data that stand at its nodes, or of who owns what in it, or a
// message to all; one peer makes it and all repeat it. Every
// author writes a log of its own, a sequence of bytes that only grows: peers exchange ranges of it (OperationPart), so
// that an operation may be larger than a datagram, and whoever holds a range can pass it on without reading it.

// An AuthorId says who writes a log. A peer that keeps no store begins a new log with each start, so this is not its
// PeerId. It is the origin of the ids of what its operations add. From 1, below 2^31; 0: nobody.
using AuthorId = Strong<struct AuthorIdTag, std::uint32_t>;
inline constexpr AuthorId kNoAuthor{0};
inline constexpr std::uint32_t kAuthorMax = (std::uint32_t{1} << 31) - 1;

struct OperationId {
  AuthorId author;
  std::uint32_t number = 0;  // in its log, from 1 and without gaps

  friend constexpr auto operator<=>(const OperationId&, const OperationId&) = default;
};

// The nodes of a VRML text, whose ids count on from `first_object` and `first_node`, of the author.
struct AddNodes {
  std::optional<ObjectId> parent;  // none: at the top level
  std::optional<ObjectId> before;  // among the children of the parent; none: behind all of them
  std::string text;
  std::uint32_t first_object = 0, first_node = 0;
  // What paths in the text mean that name nothing in it, as the author saw it.
  std::vector<std::pair<std::string, ObjectId>> names{};

  friend bool operator==(const AddNodes&, const AddNodes&) = default;
};

struct RemoveObject {  // with all below it
  ObjectId object;

  friend bool operator==(const RemoveObject&, const RemoveObject&) = default;
};

struct RemoveNode {  // one that is no instance: an interest, a TimeSensor
  NodeId node;

  friend bool operator==(const RemoveNode&, const RemoveNode&) = default;
};

struct MoveObject {
  ObjectId object;
  std::optional<ObjectId> parent, before;  // as in AddNodes

  friend bool operator==(const MoveObject&, const MoveObject&) = default;
};

struct SetField {
  NodeId node;
  std::string field, value;      // the value in the notation of VRML
  std::uint32_t first_node = 0;  // ids of nodes in the value count on from this one, of the author

  friend bool operator==(const SetField&, const SetField&) = default;
};

struct ChangeRoute {
  NodeId from, to;
  std::string event_out, event_in;
  bool removes = false;  // else it adds the ROUTE

  friend bool operator==(const ChangeRoute&, const ChangeRoute&) = default;
};

// The object is the owner's from the stamp on. Where an operation has given it to another peer than `before` meanwhile,
// this one changes nothing: of two peers that take an object at once the earlier one has it.
struct GiveObject {
  ObjectId object;
  PeerId owner;                          // kNobody: nobody's
  PeerId before;                         // whose it was, as the author saw it
  std::optional<Placement> placement{};  // of its Transform, from then on; none: as it is

  friend bool operator==(const GiveObject&, const GiveObject&) = default;
};

// A peer asks the owner for an object, which answers by a GiveObject, or by a RefuseRequest. A request whose stamp is
// older than kAnsweredWithin is not answered any more; the peer that has asked gives up after kAskedFor.
inline constexpr Duration kAnsweredWithin = std::chrono::seconds(1), kAskedFor = std::chrono::seconds(2);
struct RequestObject {
  ObjectId object;
  PeerId owner, by;

  friend bool operator==(const RequestObject&, const RequestObject&) = default;
};
// How a peer comes to own an object.
struct Taking {
  OperationId operation;
  bool asks = false;  // another peer, by a RequestObject; else it takes what is nobody's
};
struct RefuseRequest {
  OperationId request;
  std::string reason;  // one sentence

  friend bool operator==(const RefuseRequest&, const RefuseRequest&) = default;
};

// The object's owner has left it behind: from then on its Transform says where it stood. An owner that has gone on
// meanwhile, because it was only silent, stays where it is.
struct PlaceObject {
  ObjectId object;
  PeerId owner;  // whose it was
  SimTime at{};  // session time at which it stood there
  Placement placement;

  friend bool operator==(const PlaceObject&, const PlaceObject&) = default;
};

// A value that an application keeps at a node, under a key: any bytes. It goes with the node.
struct SetData {
  NodeId node;
  std::string key;
  std::optional<std::string> value;  // none: the key is removed

  friend bool operator==(const SetData&, const SetData&) = default;
};

// From the stamp on nobody but its writer (Writer) changes the object and what is below it, until an operation unlocks
// it.
struct LockObject {
  ObjectId object;
  bool unlocks = false;  // else it locks

  friend bool operator==(const LockObject&, const LockObject&) = default;
};

// A message of an application to all peers. It changes nothing.
struct SendMessage {
  PeerId by;
  std::string topic, text;  // any bytes

  friend bool operator==(const SendMessage&, const SendMessage&) = default;
};

// From the stamp on the scene is as if that earlier operation of the same author had never been, but for its ids; or
// as if it had not been undone.
struct UndoOperation {
  std::uint32_t number = 0;
  SimTime stamp{};  // of that operation
  bool redoes = false;

  friend bool operator==(const UndoOperation&, const UndoOperation&) = default;
};

using OperationBody =
    std::variant<AddNodes, RemoveObject, RemoveNode, MoveObject, SetField, ChangeRoute, GiveObject, RequestObject,
                 RefuseRequest, SetData, SendMessage, UndoOperation, PlaceObject, LockObject>;

// An edit that a peer has just undone or redone: by which operation, which one, and what that was (kind_of()).
struct UndoneEdit {
  OperationId operation, edit;
  std::string kind;
};

// The place of a kind among all: OperationBody::index().
template <class Kind>
inline constexpr std::size_t kIndexOf = []<class... Kinds>(std::type_identity<std::variant<Kinds...>>) {
  std::size_t index = 0;
  const bool is_found = ((std::is_same_v<Kind, Kinds> || (++index, false)) || ...);
  static_assert((std::is_same_v<Kind, Kinds> || ...));
  return is_found ? index : std::variant_npos;
}(std::type_identity<OperationBody>{});

// The word for it in logs and listings: add, remove, set, lock, unlock, ..
[[nodiscard]] const char* kind_of(const OperationBody& body);

struct Operation {
  OperationId id;
  // The session time from which on the operation holds: so far ahead of when it was made that all peers have it by
  // then, and later than all stamps that its author knew: a hybrid logical clock (Kulkarni et al. 2014) whose counter
  // is in the nanoseconds. All peers apply operations in the order of stamp and id.
  SimTime stamp{};
  OperationBody body;
  // Which operations of others its author knew that it had not named so before: of each of these logs all up to that
  // number. Authors ascend.
  std::vector<OperationId> knows{};
};

// An operation says no more; the next ones of its author say the rest.
inline constexpr std::size_t kKnowsMax = 512;

// Stamps farther ahead of session time are of a broken clock: they wait for their time, and no other stamp is later
// because of them.
inline constexpr Duration kStampAheadMax = std::chrono::seconds(10);

// Bytes [from, from + bytes.size()) of an author's log.
struct OperationPart {
  AuthorId author;
  std::uint64_t from = 0;
  std::vector<std::byte> bytes;
};

// Bytes [from, to) of an author's log, which the sender asks for.
struct OperationRange {
  AuthorId author;
  std::uint64_t from = 0, to = 0;

  friend constexpr auto operator<=>(const OperationRange&, const OperationRange&) = default;
};

// How many bytes of an author's log the sender holds, from the first on.
struct LogLength {
  AuthorId author;
  std::uint64_t bytes = 0;

  friend constexpr auto operator<=>(const LogLength&, const LogLength&) = default;
};

// The largest operation in bytes; what is larger is refused where it is made.
inline constexpr std::size_t kOperationMax_bytes = std::size_t{1} << 20;

// An operation as it stands in its author's log: its size as a varint, then a message `Operation` of proto/peerd.proto.
[[nodiscard]] std::vector<std::byte> encode(const Operation& operation);
// The same with the author's key, which may be empty, and with kSignature_bytes zeros at its end, for a signature.
inline constexpr std::size_t kSignature_bytes = 64;
[[nodiscard]] std::vector<std::byte> encode_unsigned(const Operation& operation, std::span<const std::byte> key);

// An operation as it stands in a log, of which nothing but the size has been read. All spans are into that log.
struct SignedOperation {
  std::span<const std::byte> entry;      // with its size
  std::span<const std::byte> is_signed;  // what the signature is over, besides what precedes it in the log
  std::span<const std::byte> signature;  // kSignature_bytes; empty: it has none
};
// The operation at the beginning of these bytes; null: they are not the whole of it yet. The error says why nobody can
// read on in this log.
[[nodiscard]] std::expected<std::optional<SignedOperation>, const char*> signed_operation(
    std::span<const std::byte> log);
// The author's key in the operation; empty: it has none, or can't be read.
[[nodiscard]] std::vector<std::byte> key_in(const SignedOperation& operation);

struct DecodedOperation {
  Operation operation;
  std::size_t size_bytes = 0;  // in the log
};
// The operation at the beginning of these bytes of the author's log; null: they are not the whole of it yet. The error
// says why nobody can read on in this log.
[[nodiscard]] std::expected<std::optional<DecodedOperation>, const char*> decode_operation(
    AuthorId author, std::span<const std::byte> log);
// The size in the log of the operation at the beginning of these bytes, which has been decoded once.
[[nodiscard]] std::size_t operation_size_bytes(std::span<const std::byte> log);

}  // namespace peerd::replication
