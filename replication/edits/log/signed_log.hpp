#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "replication/edits/log/log_signer.hpp"

namespace peerd::replication {

// A SignedLog knows of the signatures of one author's log: the digest of all operations that have been checked or
// signed, and the key that they are by.
class SignedLog {
 public:
  // Signs an operation, which follows those so far. The bytes are those of encode_unsigned(), with its key.
  void sign(const LogSigner& signer, AuthorId author, std::span<std::byte> operation);
  // The key that the next own operation must carry.
  [[nodiscard]] std::vector<std::byte> key_of_next(const LogSigner& signer) const;

  struct Checked {
    std::size_t bytes = 0;        // of whole operations that their author has signed
    const char* wrong = nullptr;  // why the bytes behind these must go; null: they need not
  };
  // Checks the operations in these bytes, which follow those so far.
  [[nodiscard]] Checked check(const LogSigner& signer, AuthorId author, std::span<const std::byte> log);

 private:
  LogSigner::Digest digest_{};  // of all operations with their signatures
  std::vector<std::byte> key_;  // empty: no operation so far
};

}  // namespace peerd::replication
