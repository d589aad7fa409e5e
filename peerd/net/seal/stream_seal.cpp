#include "peerd/net/seal/stream_seal.hpp"

#include <sodium.h>

#include <algorithm>
#include <cassert>

#include "peerd/net/keys/little_endian.hpp"

namespace peerd::seal {
namespace {

static_assert(StreamSeal::kHello_bytes == crypto_scalarmult_BYTES);
static_assert(keys::SymmetricKey::kBytes == crypto_scalarmult_SCALARBYTES);
static_assert(StreamSeal::kAdded_bytes == crypto_aead_chacha20poly1305_ietf_ABYTES);

const std::uint8_t* bytes_of(std::string_view text) { return reinterpret_cast<const std::uint8_t*>(text.data()); }

std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES> nonce_of(std::uint64_t number) {
  std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES> nonce{};
  keys::put(number, std::span(nonce).first<sizeof(number)>());
  return nonce;
}

using Proof = std::array<std::uint8_t, StreamSeal::kProof_bytes>;

Proof proof_of(const keys::SymmetricKey& session, std::string_view hello) {
  const keys::SymmetricKey of_hello = session.derived("who joins", {bytes_of(hello), hello.size()});
  Proof proof{};
  std::copy_n(of_hello.data(), proof.size(), proof.begin());
  return proof;
}

}  // namespace

StreamSeal::StreamSeal(const keys::SymmetricKey& session, End end)
    : session_(session), secret_(keys::SymmetricKey::random()), end_(end) {
  crypto_scalarmult_base(hello_.data(), secret_.data());
}

std::string StreamSeal::proven_hello() const {
  std::string frame(hello_.begin(), hello_.end());
  const Proof proof = proof_of(session_, frame);
  frame.append(proof.begin(), proof.end());
  return frame;
}

bool StreamSeal::is_proven(const keys::SymmetricKey& session, std::string_view frame) {
  if (!has_proof(frame)) return false;
  const Proof right = proof_of(session, frame.substr(0, kHello_bytes));
  return sodium_memcmp(bytes_of(frame.substr(kHello_bytes)), right.data(), right.size()) == 0;
}

bool StreamSeal::take_hello(std::string_view hello) {
  assert(!out_);
  if (hello.size() != kHello_bytes) return false;
  // Both public keys go in beside what the two make together, so that somebody between them can't give each another
  // one.
  std::array<std::uint8_t, 3 * kHello_bytes> made{};
  const auto shared = made.begin(), of_client = shared + kHello_bytes, of_server = of_client + kHello_bytes;
  if (crypto_scalarmult(made.data(), secret_.data(), bytes_of(hello)) != 0) return false;  // a point of low order
  std::ranges::copy(hello_, end_ == End::kClient ? of_client : of_server);
  std::copy_n(bytes_of(hello), kHello_bytes, end_ == End::kClient ? of_server : of_client);
  keys::SymmetricKey to_server = session_.derived("to the server", made);
  keys::SymmetricKey to_client = session_.derived("to the client", made);
  sodium_memzero(made.data(), made.size());
  out_ = end_ == End::kClient ? to_server : to_client;
  in_ = end_ == End::kClient ? to_client : to_server;
  return true;
}

std::string StreamSeal::seal(std::string_view frame) {
  assert(out_);
  std::string sealed(frame.size() + kAdded_bytes, '\0');
  crypto_aead_chacha20poly1305_ietf_encrypt(reinterpret_cast<std::uint8_t*>(sealed.data()), nullptr, bytes_of(frame),
                                            frame.size(), nullptr, 0, nullptr, nonce_of(sent_++).data(), out_->data());
  return sealed;
}

std::optional<std::string> StreamSeal::open(std::string_view sealed) {
  assert(in_);
  if (sealed.size() < kAdded_bytes) return std::nullopt;
  std::string frame(sealed.size() - kAdded_bytes, '\0');
  const int failed = crypto_aead_chacha20poly1305_ietf_decrypt(reinterpret_cast<std::uint8_t*>(frame.data()), nullptr,
                                                               nullptr, bytes_of(sealed), sealed.size(), nullptr, 0,
                                                               nonce_of(taken_).data(), in_->data());
  if (failed != 0) return std::nullopt;
  ++taken_;
  return frame;
}

}  // namespace peerd::seal
