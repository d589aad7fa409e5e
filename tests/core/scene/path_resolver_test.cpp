#include "core/scene/path_resolver.hpp"

#include <random>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::path_resolver_test {

// The names are used again, look like child indices, hold a '/', or stand in PROTOs only.
std::string random_world(std::mt19937& random) {
  const char* const names[] = {"", "", "DEF A ", "DEF B ", "DEF n1 ", "DEF A/B ", "DEF A/0 "};
  const auto below = [&](std::size_t n) { return random() % n; };
  std::string body = "PROTO P [ ] { DEF IN Group { children [ DEF A Group { } DEF ONLY Shape { } ] } }\n";
  std::size_t open = 0;
  for (int i = 0; i < 30; ++i) {
    const std::string name = names[below(std::size(names))];
    switch (below(5)) {
      case 0:
        body += name + "P { } ";
        break;
      case 1:
        body += "PointLight { } ";  // no instance: it takes a child index all the same
        break;
      case 2:
        body += name + "Shape { } ";
        break;
      case 3:
        body += name + "Group { children [ ";
        ++open;
        break;
      default:
        if (open == 0) break;
        body += "] } ";
        --open;
    }
  }
  for (; open > 0; --open) body += "] } ";
  return body;
}

std::string random_path(std::mt19937& random) {
  const char* const parts[] = {"A", "B", "n1", "IN", "ONLY", "0", "1", "2", "07", "", "x", "+1", "99999999999"};
  std::string path = parts[random() % std::size(parts)];
  for (std::size_t i = random() % 4; i > 0; --i) path += std::string("/") + parts[random() % std::size(parts)];
  return path;
}

TEST(PathResolver, FindsWhatTheSceneFinds) {
  std::mt19937 random(7);
  std::size_t found = 0;
  for (int world = 0; world < 200; ++world) {
    const Scene scene = scene_of(random_world(random));
    PathResolver finder(scene);
    for (int i = 0; i < 200; ++i) {
      const std::string path = random_path(random);
      const auto expected = scene.find(path);
      ASSERT_EQ(finder.find(path), expected) << path;
      found += expected.has_value();
    }
    for (const std::string& path : paths_of(scene)) ASSERT_EQ(finder.find(path), scene.find(path)) << path;
  }
  EXPECT_GT(found, 5'000u);
}

}  // namespace peerd::vrml::path_resolver_test
