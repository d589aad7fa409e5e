#pragma once
#include <functional>
#include <string>

#include "replication/wire/operation.hpp"

namespace peerd::replication {

// A Writer is the user whose operations an author's log has: one for all authors of one key, and for one without a key
// that author alone. A Writer may get to do more while a session lasts, and never less, so that all peers come to
// agree.
struct Writer {
  std::string user;        // no two users have the same
  std::string name{};      // for people; empty: its authors' numbers stand for it
  bool may_lock = true;    // and unlock what anybody has locked
  bool overrules = false;  // no lock keeps it from anything

  friend bool operator==(const Writer&, const Writer&) = default;
};
using WriterOf = std::function<Writer(AuthorId)>;

// The writer where nobody has a key.
[[nodiscard]] inline Writer writer_without_key(AuthorId author) { return {.user = std::to_string(author.value)}; }

}  // namespace peerd::replication
