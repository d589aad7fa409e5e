#include "peerd/seal/replay_window.hpp"

#include <algorithm>

namespace peerd::seal {

bool ReplayWindow::take(std::uint64_t counter) {
  if (counter == 0 || counter + kWidth <= newest_) return false;
  const std::uint64_t word = counter / kWord_bits;
  if (counter > newest_) {
    const std::uint64_t newer = std::min(word - newest_ / kWord_bits, kWords);
    for (std::uint64_t i = 0; i < newer; ++i) words_[(word - i) % kWords] = 0;
    newest_ = counter;
  }
  std::uint64_t& bits = words_[word % kWords];
  const std::uint64_t bit = std::uint64_t{1} << counter % kWord_bits;
  if ((bits & bit) != 0) return false;
  bits |= bit;
  return true;
}

}  // namespace peerd::seal
