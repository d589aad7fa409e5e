#pragma once
#include <vector>

#include "core/time.hpp"

namespace peerd::replication {

// When this peer, in this life, has been in a session: by its session time, and by those of the sessions that it was in
// before, for what was written in these bears stamps of their times.
class Presence {
 public:
  // It first enters a session.
  void begin(SimTime now) {
    since_ = now;
    before_.clear();
  }
  // Session time, which was `before`, is that of another session from now on.
  void move(SimTime before, SimTime now);

  // When it came, as if its session had always had the time of this one.
  [[nodiscard]] SimTime since() const { return since_; }
  // Whether it was there at the stamp of an operation. Sessions have their times each for itself, so that what one
  // wrote that it was not in may be taken for its own's.
  [[nodiscard]] bool was_there(SimTime stamp) const;

 private:
  struct Stay {
    SimTime from, to;  // of stamps
  };
  SimTime since_{};
  std::vector<Stay> before_;  // the last ones
};

}  // namespace peerd::replication
