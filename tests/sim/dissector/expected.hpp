#pragma once
#include <charconv>
#include <concepts>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/kinematics.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::sim::dissector_test {

// The values of each field by its name, in order of appearance.
using Fields = std::map<std::string, std::vector<std::string>>;

// The fields of expert information. The first two mark a packet as refused: of such a one no other field counts.
inline constexpr const char* kMalformed = "peerd.malformed";
inline constexpr const char* kMalformedJoin = "peerd_join.malformed";
inline constexpr const char* kUnreadable = "peerd.operation.malformed";
inline constexpr const char* kForked = "peerd.operations.forked";

// Stands for a text that the two programs print in ways of their own: with control characters, bytes that are not
// UTF-8, or what stands for them.
inline constexpr const char* kAnyText = "\3";

// What tshark prints for no bytes.
inline constexpr const char* kNoBytes = "<MISSING>";

[[nodiscard]] std::string hex(std::span<const std::byte> bytes);

// The Expected are the fields that tshark should report of a packet.
class Expected {
 public:
  // `protocol` begins the names of all fields.
  explicit Expected(std::string protocol = "peerd.") : protocol_(std::move(protocol)) {}

  void add(const std::string& name, const std::string& value) { fields_[protocol_ + name].push_back(value); }
  void add(const std::string& name, double x) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, x).ptr;
    add(name, std::string(text, end));
  }
  template <std::integral T>
  void add(const std::string& name, T n) {
    add(name, std::to_string(n));
  }
  // Protobuf sends no zeros.
  template <std::integral T>
  void add_unless_zero(const std::string& name, T n) {
    if (n != 0) add(name, n);
  }
  // As tshark prints text and bytes.
  void add_text(const std::string& name, std::string_view text);
  void add_bytes(const std::string& name, std::string_view bytes) {
    add(name, bytes.empty() ? kNoBytes : hex(std::as_bytes(std::span(bytes))));
  }
  void add(const std::string& name, SimTime t) { add(name, t.time_since_epoch().count()); }
  void add(const std::string& name, const Vec3& v) {
    add(name + ".x", v.x());
    add(name + ".y", v.y());
    add(name + ".z", v.z());
  }
  void add(const std::string& name, const Quat& q) {
    add(name + ".w", q.w());
    add(name + ".x", q.x());
    add(name + ".y", q.y());
    add(name + ".z", q.z());
  }
  [[nodiscard]] const Fields& fields() const { return fields_; }

 private:
  std::string protocol_;
  Fields fields_;
};

// The names that the dissector gives the kinds of operations, in the order of replication::OperationBody.
[[nodiscard]] std::span<const char* const> kinds_of_operations();

// The logs of all authors, as far as the packets of a capture have brought them.
class SeenOperations {
 public:
  struct Shown {
    replication::Operation operation;
    std::uint64_t from = 0, to = 0;  // of its bytes in the log
    std::vector<std::byte> key{}, signature{};
    bool is_repeated = false;  // an earlier part has shown it
  };
  struct Said {
    std::vector<Shown> operations;
    bool is_unreadable = false;  // from this part on nobody can read on in the log
    bool is_forked = false;      // the part differs from what is known
  };
  // A part shows the operations whose last byte it brings, and those that its bytes make whole.
  Said take(const replication::OperationPart& part);
  // Bytes of a log that have come to be known by another way, and that no part has shown.
  void learn(const replication::OperationPart& part) { receive(part); }

 private:
  void receive(const replication::OperationPart& part);

  replication::OperationLogs logs_;
  std::map<replication::AuthorId, std::vector<Shown>> whole_;  // of each log, ascending
  // The bytes of parts by their places. Where parts differ, those of the first one count; a peer drops both if there is
  // a gap before them.
  std::map<replication::AuthorId, std::map<std::uint64_t, std::byte>> first_;
};

// What our own readers say of the packets of one capture, in their order.
class Readers {
 public:
  // Operations that no packet of the capture has brought.
  void learn(const replication::OperationPart& part) { operations_[RegionId{0}].learn(part); }
  // Of a datagram without the header of its region. It is malformed where our decoder refuses it. The times in it are
  // those nearest to `near`.
  [[nodiscard]] Fields datagram(std::span<const std::byte> datagram, RegionId region, SimTime near);
  // Of a datagram at the port of discovery.
  [[nodiscard]] static Fields discovery(std::span<const std::byte> datagram);
  // Of the bytes that a side of a TCP connection sends in packet `number`: of the frames that end in them.
  [[nodiscard]] Fields segment(const std::string& connection, bool from_client, std::string_view bytes,
                               std::size_t number);

 private:
  struct Connection {
    std::string unread[2];                                                  // from the server, from the client
    std::deque<std::pair<std::size_t, replication::OperationRange>> asked;  // the packets of unanswered requests
  };
  void frame(Expected& out, Connection& connection, bool from_client, const std::string& frame, std::size_t number);

  std::map<RegionId, SeenOperations> operations_;  // a group of its own may be of another session
  std::map<std::string, Connection> connections_;
};

}  // namespace peerd::sim::dissector_test
