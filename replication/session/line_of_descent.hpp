#pragma once
#include <cstdint>

namespace peerd::replication {

// The edits of a world descend from its file by a line. Line 0 is that of all who begin with the file, and whose edits
// are brought together wherever they meet; `--fresh` begins a line of its own. Edits of two lines are never mixed.
struct LineOfDescent {
  std::uint64_t line = 0;
  bool has_edits = false;
  bool in_session = false;  // its peer has entered one, or has it from one

  // This peer has begun with the world's file and has no edits: nothing is lost if it takes another line.
  [[nodiscard]] bool is_blank() const { return line == 0 && !has_edits; }
};

// The step of a peer that meets another one.
enum class LineMeeting : std::uint8_t {
  kSame,    // both are of one line
  kStay,    // the other peer comes over
  kTake,    // this peer has no edits, and is of the other line from now on
  kGoOver,  // this peer has edits, which must be put aside: it begins anew, with the other line
  kApart,   // both are in sessions that have edits: neither follows, until a person starts one of them again
};

// The results of both peers fit each other: where one stays, the other comes over. A blank line gives way to any other,
// a newcomer to a session, a session without edits to one with edits, and else the lower line to the higher one, which
// was begun later.
[[nodiscard]] LineMeeting meet(const LineOfDescent& own, const LineOfDescent& other);

}  // namespace peerd::replication
