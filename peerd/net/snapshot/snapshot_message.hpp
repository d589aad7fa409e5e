#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "replication/wire/operation.hpp"

namespace peerd::snapshot {

// A snapshot is what a joining peer needs before it meets the peers of a session: the archive of the world's first
// files (WorldArchive), the settings that all peers share, and the logs of all operations. The archive and the
// logs are the same bytes at all peers, so that parts of them can come from several, over several connections at once.

// A part has at most so many bytes before it is compressed: two or three round trips of a connection in slow start. A
// request and a reply have at most so many.
inline constexpr std::size_t kPartMax_bytes = 32 * 1024;
inline constexpr std::size_t kRequestMax_bytes = 1024 * 1024, kReplyMax_bytes = 2 * 1024 * 1024;

struct OfferRequest {
  friend bool operator==(const OfferRequest&, const OfferRequest&) = default;
};

// Some bytes of a log, or, with kNoAuthor, of the archive; from < to.
struct PartRequest {
  replication::OperationRange range;

  friend bool operator==(const PartRequest&, const PartRequest&) = default;
};

// It asks for the digests of the beginnings of logs that are so long.
struct DigestRequest {
  std::vector<replication::LogLength> logs;

  friend bool operator==(const DigestRequest&, const DigestRequest&) = default;
};

struct Request {
  std::uint64_t session = 0;  // Beacon::session; a peer of another one refuses. 0: whichever it is
  std::variant<OfferRequest, PartRequest, DigestRequest> what;

  friend bool operator==(const Request&, const Request&) = default;
};

// An Offer says what a peer has to give.
struct Offer {
  std::uint32_t protocol = 0;  // replication::kProtocolVersion
  std::uint64_t session = 0;   // Beacon::session
  std::string world;           // its name, for people
  std::string settings;        // those that all peers of the session share, as a configuration (TOML)
  std::uint64_t genesis = 0;   // config::LoadedWorld::hash
  std::uint64_t archive_bytes = 0, archive_digest = 0;
  std::vector<replication::LogLength> logs;  // whole operations
  std::uint64_t line = 0;                    // of descent, of these (replication::LineOfDescent)

  friend bool operator==(const Offer&, const Offer&) = default;
};

struct Part {
  std::string bytes;  // unpacked; those that were asked for

  friend bool operator==(const Part&, const Part&) = default;
};

// In the order of the request; 0: this peer does not hold so much of that log.
struct Digests {
  std::vector<std::uint64_t> digests;

  friend bool operator==(const Digests&, const Digests&) = default;
};

struct Refusal {
  std::string why;  // for people

  friend bool operator==(const Refusal&, const Refusal&) = default;
};

using Reply = std::variant<Refusal, Offer, Part, Digests>;

[[nodiscard]] std::string encode(const Request& request);
[[nodiscard]] std::string encode(const Reply& reply);
// Both parse hostile input; the error says in a few words what is wrong.
[[nodiscard]] std::expected<Request, std::string> decode_request(std::string_view bytes);
[[nodiscard]] std::expected<Reply, std::string> decode_reply(std::string_view bytes);

// Makes a number for bytes that are to be compared with another peer's (as FNV-1a, by words of eight bytes), never 0.
// It shows damage and differences, not a forger's work.
class Digester {
 public:
  static constexpr std::size_t kWord_bytes = 8;

  // `bytes`: so many will be added in all.
  explicit Digester(std::uint64_t bytes);
  // Adds what comes next: whole words, unless it is the last.
  void add(std::string_view bytes);
  [[nodiscard]] std::uint64_t value() const { return hash_ == 0 ? 1 : hash_; }

 private:
  std::uint64_t hash_;
};
[[nodiscard]] std::uint64_t digest(std::string_view bytes);

}  // namespace peerd::snapshot
