#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "replication/settings/policy/writer.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// An Author writes a log. A signer makes its number of its key and of random bits, so that nobody else can begin a log
// in its place; without a signer, it is any number.
struct Author {
  AuthorId id = kNoAuthor;
  std::uint64_t salt = 0;
};

// Signs the operations of an author's log, and checks those of others. A signature is over all of the log before it:
// each operation goes into a digest of the ones before, so that one signature that is good vouches for a whole log.
class LogSigner {
 public:
  using Digest = std::array<std::uint8_t, 32>;
  using Signature = std::span<const std::byte, kSignature_bytes>;

  LogSigner() = default;
  LogSigner(const LogSigner&) = delete;
  LogSigner& operator=(const LogSigner&) = delete;
  virtual ~LogSigner() = default;

  // A digest of another one and of bytes, by which nobody finds others that have it, too.
  [[nodiscard]] virtual Digest digest(const Digest& before, std::span<const std::byte> bytes) const = 0;
  // The key that the first operation of the own log carries; the author's number must be of this key.
  [[nodiscard]] virtual std::vector<std::byte> own_key() const = 0;
  [[nodiscard]] virtual std::array<std::byte, kSignature_bytes> sign(AuthorId author, const Digest& digest) const = 0;

  // Why this peer may not write, in a sentence; null: it may.
  [[nodiscard]] virtual const char* why_not_write() const = 0;
  // Why that key may not write a log, as the name of a drop reason; null: it may. kForgedOperation: it is not that
  // author's.
  [[nodiscard]] virtual const char* refused(AuthorId author, std::span<const std::byte> key) const = 0;
  [[nodiscard]] virtual bool is_good(AuthorId author, std::span<const std::byte> key, const Digest& digest,
                                     Signature signature) const = 0;
  // The user whose key that is, and what it may do to locks.
  [[nodiscard]] virtual Writer writer(std::span<const std::byte> key) const = 0;
};

// Drop reasons. What is forged or unsigned is not kept, and the log goes on with other bytes in its place.
inline constexpr const char* kForgedOperation = "forged_operation";
inline constexpr const char* kUnsignedOperation = "unsigned_operation";

}  // namespace peerd::replication
