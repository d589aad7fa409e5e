// collision_hash: prints scene_hash.hpp's number. Exit code 1: it is not the one that is written there.
#include <cstdio>

#include "tests/collision/scene_hash.hpp"

int main() {
  const auto hash = peerd::collision::scene_hash();
  std::printf("%llu\n", static_cast<unsigned long long>(hash));
  return hash == peerd::collision::kSceneHash ? 0 : 1;
}
