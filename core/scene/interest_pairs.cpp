#include "core/scene/interest_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <unordered_set>

namespace peerd {
namespace {

std::vector<ObjectId> found_by(const InterestSide& side, vrml::PathResolver& paths) {
  std::vector<ObjectId> found;
  for (const NamePattern& pattern : side.patterns) {
    const std::vector<ObjectId> more = paths.find_all(pattern);
    found.insert(found.end(), more.begin(), more.end());
  }
  return found;
}

}  // namespace

void find_ends(CollisionInterest& interest, vrml::PathResolver& paths) {
  std::unordered_set<ObjectId> left_out(interest.except.ends.begin(), interest.except.ends.end());
  for (const ObjectId id : found_by(interest.except, paths)) left_out.insert(id);
  for (InterestSide* const side : {&interest.colliders, &interest.collidees}) {
    assert(side->named <= side->ends.size());
    side->ends.resize(side->named);
    if (side->patterns.empty()) continue;
    std::unordered_set<ObjectId> known = left_out;
    known.insert(side->ends.begin(), side->ends.end());
    for (const ObjectId id : found_by(*side, paths)) {
      if (known.insert(id).second) side->ends.push_back(id);
    }
    std::ranges::sort(side->ends.begin() + static_cast<std::ptrdiff_t>(side->named), side->ends.end(), {},
                      [&](ObjectId id) { return paths.scene().index_of(id); });
  }
}

InterestPairs::InterestPairs(const Scene& scene, const CollisionInterest& interest)
    : colliders_(ends_of(scene, interest.colliders)), collidees_(ends_of(scene, interest.collidees)) {}

std::vector<InterestPairs::End> InterestPairs::ends_of(const Scene& scene, const InterestSide& side) {
  std::vector<End> ends;
  ends.reserve(side.ends.size());
  for (std::size_t i = 0; i < side.ends.size(); ++i) {
    const std::uint32_t begin = scene.index_of(side.ends[i]);
    ends.push_back(
        {side.ends[i], begin, scene.instances[begin].subtree_end, scene.object(side.ends[i]).layers, i >= side.named});
  }
  return ends;
}

std::size_t InterestPairs::count() const {
  std::size_t count = 0;
  for (const End& a : colliders_) {
    count +=
        static_cast<std::size_t>(std::ranges::count_if(collidees_, [&](const End& b) { return are_paired(a, b); }));
  }
  return count;
}

}  // namespace peerd
