#pragma once
#include "peerd/peer/record/capture.hpp"
#include "replication/edits/log/log_signer.hpp"

namespace peerd::record {

// Signs by another signer, and captures each signature, so that a replay can repeat it.
class RecordingSigner final : public replication::LogSigner {
 public:
  // It outlives this.
  explicit RecordingSigner(const LogSigner& signer) : signer_(signer) {}
  // From now on; it outlives this, or is replaced.
  void record_to(CaptureWriter* capture) { capture_ = capture; }

  [[nodiscard]] Digest digest(const Digest& before, std::span<const std::byte> bytes) const override {
    return signer_.digest(before, bytes);
  }
  [[nodiscard]] std::vector<std::byte> own_key() const override { return signer_.own_key(); }
  [[nodiscard]] std::array<std::byte, replication::kSignature_bytes> sign(replication::AuthorId author,
                                                                          const Digest& digest) const override {
    const auto signature = signer_.sign(author, digest);
    if (capture_ != nullptr) capture_->on_signed(signature);
    return signature;
  }
  [[nodiscard]] const char* why_not_write() const override { return signer_.why_not_write(); }
  [[nodiscard]] const char* refused(replication::AuthorId author, std::span<const std::byte> key) const override {
    return signer_.refused(author, key);
  }
  [[nodiscard]] bool is_good(replication::AuthorId author, std::span<const std::byte> key, const Digest& digest,
                             Signature signature) const override {
    return signer_.is_good(author, key, digest, signature);
  }
  [[nodiscard]] replication::Writer writer(std::span<const std::byte> key) const override {
    return signer_.writer(key);
  }

 private:
  const LogSigner& signer_;
  CaptureWriter* capture_ = nullptr;
};

}  // namespace peerd::record
