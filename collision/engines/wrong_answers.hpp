#pragma once
#include <cstdint>

namespace peerd::collision::engines {

// Counts how often an engine's answers to one question differ from those of another one, which is taken to be right.
struct WrongAnswers {
  std::uint64_t questions = 0;
  std::uint64_t false_touches = 0;  // it said colliding, and the other one apart
  std::uint64_t missed = 0;         // it said apart, and the other one colliding

  void count(bool said, bool right) {
    ++questions;
    false_touches += said && !right ? 1 : 0;
    missed += !said && right ? 1 : 0;
  }
  void add(const WrongAnswers& other) {
    questions += other.questions;
    false_touches += other.false_touches;
    missed += other.missed;
  }
  [[nodiscard]] std::uint64_t wrong() const { return false_touches + missed; }
};

}  // namespace peerd::collision::engines
