#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "collision/engines/closest_features.hpp"
#include "collision/engines/convex_pieces.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::engines {

// I-COLLIDE (Cohen, Lin, Manocha and Ponamgi, "I-COLLIDE: An interactive and exact collision detection system for
// large-scale environments", 1995): objects are convex pieces; sweep and prune over the pieces' boxes finds pairs of
// them, and their closest features, found by a walk from the last ones, say whether they are apart.
//
// The paper's: boxes, sweep, features, and that the order of the sweep and the features of a pair of soups are kept
// between questions (coherence). Not the paper's: the partition (convex_pieces.hpp); the sweep is along one axis, and
// the other two are compared for what meets there; the walk (closest_features.hpp); surfaces collide and not solids,
// and pieces whose features are no way apart are left to the exact triangle test. So the answers are ours.
//
// Two soups have one memory, however many Shapes share them: the answers are the same, with less coherence.
class ICollide : public NarrowPhase {
 public:
  bool find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                 PolygonPair& pair) override;
  std::vector<PolygonPair> all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                     const RelativeMotion& a_from_b) override;
  // A comparison of two pieces' boxes is a bv_test, a box taken to another frame a bv_update.
  [[nodiscard]] const QueryCounters& counters() const override { return counters_; }
  // Vertices that walks between features have visited.
  [[nodiscard]] std::uint64_t feature_steps() const { return walk_.steps(); }
  // Places by which pieces have moved in the order of the sweep; a new order counts its length.
  [[nodiscard]] std::uint64_t sort_moves() const { return sort_moves_; }

 private:
  struct Object {
    std::vector<SoupPiece> pieces;
    std::vector<WorldBox> boxes;  // of the pieces, in the soup's frame
  };
  struct PiecePair {
    std::uint32_t a = 0, b = 0;
    friend auto operator<=>(const PiecePair&, const PiecePair&) = default;
  };
  struct Near {
    PiecePair pieces;
    ClosestFeatures features;
  };
  struct Memory {
    std::vector<std::uint32_t> order;  // A's pieces, then B's, by their boxes' lower ends
    std::vector<Near> near;            // pairs whose boxes overlap, ascending
  };

  template <class Found>
  bool search(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b, Found found);
  template <class Found>
  bool touch_pieces(const TriangleSoup& a, const TriangleSoup& b, const SoupPiece& of_a, const SoupPiece& of_b,
                    Found found);
  const Object& object(const NumberedSoup& of);
  void place(const TriangleSoup& b, const Object& of_b, const RelativeMotion& a_from_b);
  void sort(std::vector<std::uint32_t>& order, const Object& a, int axis);
  void sweep(Memory& memory, const Object& a, const WorldBox& box_a);

  // Soups whose vertices move get a new number each time; what is kept of old ones is dropped together.
  static constexpr std::size_t kObjectsMax = 4096;

  std::map<std::uint64_t, Object> objects_;  // by a soup's number
  std::map<std::pair<std::uint64_t, std::uint64_t>, Memory> memories_;
  FeatureWalk walk_;
  QueryCounters counters_;
  std::uint64_t sort_moves_ = 0;
  // B's vertices and the boxes of its pieces in A's frame, in this question.
  std::vector<Vec3> moved_;
  std::vector<WorldBox> boxes_b_;
  WorldBox box_b_;
};

}  // namespace peerd::collision::engines
