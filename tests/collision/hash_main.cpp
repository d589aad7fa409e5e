// collision_hash: prints scene_hash.hpp's numbers. Exit code 1: one is not what is written there.
#include <cstdio>

#include "tests/collision/scene_hash.hpp"

int main() {
  const auto scene = peerd::collision::scene_hash(), view = peerd::collision::view_hash();
  std::printf("%llu %llu\n", static_cast<unsigned long long>(scene), static_cast<unsigned long long>(view));
  return scene == peerd::collision::kSceneHash && view == peerd::collision::kViewHash ? 0 : 1;
}
