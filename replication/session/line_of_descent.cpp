#include "replication/session/line_of_descent.hpp"

namespace peerd::replication {

LineMeeting meet(const LineOfDescent& own, const LineOfDescent& other) {
  if (own.line == other.line) return LineMeeting::kSame;
  bool stays = own.line > other.line;
  if (own.is_blank() != other.is_blank()) {
    stays = other.is_blank();
  } else if (own.in_session != other.in_session) {
    stays = own.in_session;
  } else if (own.in_session && own.has_edits && other.has_edits) {
    return LineMeeting::kApart;
  } else if (own.in_session && own.has_edits != other.has_edits) {
    stays = own.has_edits;
  }
  if (stays) return LineMeeting::kStay;
  return own.has_edits ? LineMeeting::kGoOver : LineMeeting::kTake;
}

}  // namespace peerd::replication
