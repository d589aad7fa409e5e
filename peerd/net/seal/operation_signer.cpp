#include "peerd/net/seal/operation_signer.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <string>
#include <utility>

#include "peerd/net/keys/little_endian.hpp"
#include "peerd/net/keys/symmetric_key.hpp"

namespace peerd::seal {
namespace {

using replication::AuthorId;

constexpr std::string_view kUse = "operations";
constexpr std::size_t kSalt_bytes = 8, kWorld_bytes = 8, kAuthor_bytes = 4;
constexpr std::size_t kDigest_bytes = std::tuple_size_v<replication::LogSigner::Digest>;
// The key in a log: the public key, and the author's salt.
constexpr std::size_t kKey_bytes = keys::PublicKey::kBytes + kSalt_bytes;

struct AuthorKey {
  keys::PublicKey key;
  std::uint64_t salt = 0;
};
std::optional<AuthorKey> read_key(std::span<const std::byte> key) {
  if (key.size() != kKey_bytes) return std::nullopt;
  return AuthorKey{keys::PublicKey(keys::as_octets(key).first<keys::PublicKey::kBytes>()),
                   keys::get(keys::as_octets(key).last<kSalt_bytes>())};
}

// The bytes that a signature is of: an operation of one world is none of another.
std::array<std::uint8_t, kWorld_bytes + kAuthor_bytes + kDigest_bytes> signed_bytes(
    std::uint64_t world, AuthorId author, const replication::LogSigner::Digest& digest) {
  std::array<std::uint8_t, kWorld_bytes + kAuthor_bytes + kDigest_bytes> bytes{};
  keys::put(world, std::span(bytes).first<kWorld_bytes>());
  keys::put(author.value, std::span(bytes).subspan<kWorld_bytes, kAuthor_bytes>());
  std::ranges::copy(digest, bytes.begin() + kWorld_bytes + kAuthor_bytes);
  return bytes;
}

}  // namespace

AuthorId author_of(const keys::PublicKey& key, std::uint64_t salt) {
  std::array<std::uint8_t, kSalt_bytes> salt_bytes{};
  keys::put(salt, salt_bytes);
  std::array<std::uint8_t, crypto_generichash_BYTES> hash{};
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, hash.size());
  crypto_generichash_update(&state, key.bytes().data(), key.bytes().size());
  crypto_generichash_update(&state, salt_bytes.data(), salt_bytes.size());
  crypto_generichash_final(&state, hash.data(), hash.size());
  return AuthorId{1 + static_cast<std::uint32_t>(keys::get(std::span(hash).first<8>()) % replication::kAuthorMax)};
}

replication::Author fresh_author(const keys::PublicKey& key) {
  keys::need_sodium();
  replication::Author author;
  randombytes_buf(&author.salt, sizeof(author.salt));
  author.id = author_of(key, author.salt);
  return author;
}

std::optional<keys::PublicKey> public_key_in(std::span<const std::byte> key) {
  const auto read = read_key(key);
  return read ? std::optional(read->key) : std::nullopt;
}

replication::Writer writer_without_roster(const keys::PublicKey& key) {
  return {.user = std::string(key.bytes().begin(), key.bytes().end())};
}

replication::Writer writer_by(const keys::Roster& roster, const keys::PublicKey& key) {
  replication::Writer writer = writer_without_roster(key);
  const keys::Member* const member = roster.find(key);
  if (member != nullptr) writer.name = member->name;
  writer.may_lock = writer.overrules = member != nullptr && member->role == keys::Role::kAdministrator;
  return writer;
}

OperationVerifier::OperationVerifier(std::uint64_t world, MayWrite may_write, WriterOfKey writer_of)
    : world_(world), may_write_(std::move(may_write)), writer_of_(std::move(writer_of)) {}

OperationSigner::OperationSigner(std::uint64_t world, const keys::Identity& own, std::uint64_t salt, MayWrite may_write,
                                 WriterOfKey writer_of)
    : OperationVerifier(world, std::move(may_write), std::move(writer_of)), own_(own), salt_(salt) {}

replication::Writer OperationVerifier::writer(std::span<const std::byte> key) const {
  const auto of = public_key_in(key);
  assert(of);  // refused() has passed it
  return writer_of_(*of);
}

replication::LogSigner::Digest OperationVerifier::digest(const Digest& before, std::span<const std::byte> bytes) const {
  Digest digest{};
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, digest.size());
  crypto_generichash_update(&state, before.data(), before.size());
  crypto_generichash_update(&state, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  crypto_generichash_final(&state, digest.data(), digest.size());
  return digest;
}

std::vector<std::byte> OperationSigner::own_key() const {
  std::array<std::uint8_t, kKey_bytes> key{};
  std::ranges::copy(own_.public_key().bytes(), key.begin());
  keys::put(salt_, std::span(key).last<kSalt_bytes>());
  const auto bytes = std::as_bytes(std::span(key));
  return {bytes.begin(), bytes.end()};
}

std::array<std::byte, replication::kSignature_bytes> OperationSigner::sign(AuthorId author,
                                                                           const Digest& digest) const {
  const auto signature = own_.sign(kUse, signed_bytes(world(), author, digest));
  std::array<std::byte, replication::kSignature_bytes> bytes{};
  std::ranges::copy(std::as_bytes(std::span(signature)), bytes.begin());
  return bytes;
}

const char* OperationSigner::why_not_write() const {
  return may_write(own_.public_key()) ? nullptr : "this peer is an observer, by the world's roster, and may only look";
}

const char* OperationVerifier::refused(AuthorId author, std::span<const std::byte> key) const {
  const auto read = read_key(key);
  if (!read || author_of(read->key, read->salt) != author) return replication::kForgedOperation;
  return may_write_(read->key) ? nullptr : kObserversOperation;
}

bool OperationVerifier::is_good(AuthorId author, std::span<const std::byte> key, const Digest& digest,
                                Signature signature) const {
  const auto read = read_key(key);
  const auto bytes = keys::as_octets(signature).first<keys::PublicKey::kSignature_bytes>();
  return read && read->key.has_signed(kUse, signed_bytes(world_, author, digest), bytes);
}

}  // namespace peerd::seal
