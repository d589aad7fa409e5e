#include "replication/edits/log/signed_log.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::replication {

void SignedLog::sign(const LogSigner& signer, AuthorId author, std::span<std::byte> operation) {
  const auto read = signed_operation(operation);
  assert(read && *read && !(*read)->signature.empty());
  const auto signature = signer.sign(author, signer.digest(digest_, (*read)->is_signed));
  std::ranges::copy(signature, operation.last<kSignature_bytes>().begin());
  if (key_.empty()) key_ = signer.own_key();
  digest_ = signer.digest(digest_, (*read)->entry);
}

std::vector<std::byte> SignedLog::key_of_next(const LogSigner& signer) const {
  return key_.empty() ? signer.own_key() : std::vector<std::byte>{};
}

SignedLog::Checked SignedLog::check(const LogSigner& signer, AuthorId author, std::span<const std::byte> log) {
  struct Signed {
    std::size_t end = 0;  // in the log
    LogSigner::Digest is_signed, after;
    std::span<const std::byte> signature;
  };
  std::vector<Signed> all;
  Checked checked;
  std::vector<std::byte> key = key_;
  LogSigner::Digest digest = digest_;
  for (std::size_t read = 0; read < log.size();) {
    const auto next = signed_operation(log.subspan(read));
    if (next && !*next) break;
    if (!next || (*next)->signature.empty()) {
      checked.wrong = next ? kUnsignedOperation : kForgedOperation;
      break;
    }
    if (key.empty()) {
      key = key_in(**next);
      checked.wrong = signer.refused(author, key);
      if (checked.wrong != nullptr) break;
    }
    read += (*next)->entry.size();
    const LogSigner::Digest is_signed = signer.digest(digest, (*next)->is_signed);
    digest = signer.digest(digest, (*next)->entry);
    all.push_back({read, is_signed, digest, (*next)->signature});
  }
  const auto is_good = [&](const Signed& each) {
    return signer.is_good(author, key, each.is_signed, each.signature.first<kSignature_bytes>());
  };
  const auto take = [&](const Signed& each) {
    key_ = key;
    digest_ = each.after;
    checked.bytes = each.end;
  };
  if (all.empty()) return checked;
  if (is_good(all.back())) {  // which vouches for those before it
    take(all.back());
    return checked;
  }
  for (const Signed& each : all) {
    if (!is_good(each)) break;
    take(each);
  }
  checked.wrong = kForgedOperation;
  return checked;
}

}  // namespace peerd::replication
