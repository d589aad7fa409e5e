#pragma once
#include <chrono>
#include <thread>

namespace peerd::testing_support {

// Evaluates the condition every 5 ms until it holds, for at most `within_s` seconds. Returns whether it came to hold.
template <class Condition>
bool comes_true(const Condition& holds, double within_s) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::duration<double>(within_s);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace peerd::testing_support
