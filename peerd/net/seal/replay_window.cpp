#include "peerd/net/seal/replay_window.hpp"

#include <algorithm>

namespace peerd::seal {

bool ReplayWindow::would_take(std::uint64_t counter) const {
  if (counter == 0 || counter + kWidth <= newest_) return false;
  return counter > newest_ || (words_[counter / kWord_bits % kWords] >> counter % kWord_bits & 1) == 0;
}

bool ReplayWindow::take(std::uint64_t counter) {
  if (!would_take(counter)) return false;
  const std::uint64_t word = counter / kWord_bits;
  if (counter > newest_) {
    const std::uint64_t newer = std::min(word - newest_ / kWord_bits, kWords);
    for (std::uint64_t i = 0; i < newer; ++i) words_[(word - i) % kWords] = 0;
    newest_ = counter;
  }
  words_[word % kWords] |= std::uint64_t{1} << counter % kWord_bits;
  return true;
}

}  // namespace peerd::seal
