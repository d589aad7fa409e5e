#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/roster.hpp"
#include "replication/edits/log/log_signer.hpp"

namespace peerd::seal {

// An author of that key whom nobody has been before: its number is a hash of the key and of random bits.
[[nodiscard]] replication::Author fresh_author(const keys::PublicKey& key);
[[nodiscard]] replication::AuthorId author_of(const keys::PublicKey& key, std::uint64_t salt);

// The public key in the key that the first operation of a log has; none: it is no such key.
[[nodiscard]] std::optional<keys::PublicKey> public_key_in(std::span<const std::byte> key);

// The user who has that key, where no roster says more: one like all others.
[[nodiscard]] replication::Writer writer_without_roster(const keys::PublicKey& key);
// The same by a roster, to which all agree in the end: whom it names as an administrator is one for good.
[[nodiscard]] replication::Writer writer_by(const keys::Roster& roster, const keys::PublicKey& key);

// Checks operations (docs/protocol.md, Operations).
class OperationVerifier : public replication::LogSigner {
 public:
  // Whether whoever has that key may change the world.
  using MayWrite = std::function<bool(const keys::PublicKey&)>;

  // Who a user is as a writer, and what it may do to locks.
  using WriterOfKey = std::function<replication::Writer(const keys::PublicKey&)>;

  // `world`: the hash of its file, which each signature is for.
  OperationVerifier(std::uint64_t world, MayWrite may_write, WriterOfKey writer_of = writer_without_roster);

  [[nodiscard]] Digest digest(const Digest& before, std::span<const std::byte> bytes) const override;
  [[nodiscard]] const char* refused(replication::AuthorId author, std::span<const std::byte> key) const override;
  [[nodiscard]] bool is_good(replication::AuthorId author, std::span<const std::byte> key, const Digest& digest,
                             Signature signature) const override;
  [[nodiscard]] replication::Writer writer(std::span<const std::byte> key) const override;

 protected:
  [[nodiscard]] std::uint64_t world() const { return world_; }
  [[nodiscard]] bool may_write(const keys::PublicKey& key) const { return may_write_(key); }

 private:
  std::uint64_t world_;
  MayWrite may_write_;
  WriterOfKey writer_of_;
};

// Signs a peer's operations by its identity besides.
class OperationSigner final : public OperationVerifier {
 public:
  // `salt`: of the author of the own log.
  OperationSigner(std::uint64_t world, const keys::Identity& own, std::uint64_t salt, MayWrite may_write,
                  WriterOfKey writer_of = writer_without_roster);

  [[nodiscard]] std::vector<std::byte> own_key() const override;
  [[nodiscard]] std::array<std::byte, replication::kSignature_bytes> sign(replication::AuthorId author,
                                                                          const Digest& digest) const override;
  [[nodiscard]] const char* why_not_write() const override;

 private:
  keys::Identity own_;
  std::uint64_t salt_;
};

// The drop reason for operations of who may only look.
inline constexpr const char* kObserversOperation = "observers_operation";

}  // namespace peerd::seal
