#include "collision/tree/kdop_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "collision/tree/kdop_volume.hpp"

namespace peerd::collision {
namespace kdop_tree_detail {

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

// A box of floats for the surface-area heuristic.
struct AreaBox {
  std::array<float, 3> lo = {kFloatInfinity, kFloatInfinity, kFloatInfinity},
                       hi = {-kFloatInfinity, -kFloatInfinity, -kFloatInfinity};
  void merge(const float* p) {
    for (std::size_t i = 0; i < 3; ++i) {
      lo[i] = std::min(lo[i], p[i]);
      hi[i] = std::max(hi[i], p[i]);
    }
  }
  void merge(const AreaBox& other) {
    merge(other.lo.data());
    merge(other.hi.data());
  }
  [[nodiscard]] double half_area() const {
    const auto side = [&](std::size_t k) { return static_cast<double>(hi[k]) - static_cast<double>(lo[k]); };
    const double x = side(0), y = side(1), z = side(2);
    return x < 0.0 ? 0.0 : x * y + y * z + z * x;
  }
};

constexpr std::size_t kBins = 16;
struct Bin {
  AreaBox box;
  std::uint32_t count = 0;
};

}  // namespace kdop_tree_detail
namespace {

using kdop_tree_detail::AreaBox;
using kdop_tree_detail::Bin;
using kdop_tree_detail::kBins;
using kdop_tree_detail::kFloatInfinity;

// Whether a k-DOP lies within another.
template <int K>
bool contains(const BasicKdop<K, float>& outer, const BasicKdop<K, float>& inner) {
  for (std::size_t i = 0; i < outer.kSlabs; ++i) {
    if (inner.lo[i] < outer.lo[i] || inner.hi[i] > outer.hi[i]) return false;
  }
  return true;
}

template <int K>
double shared_volume(const Kdop<K>& a, const Kdop<K>& b) {
  WideKdop<K> both;
  for (std::size_t i = 0; i < both.kSlabs; ++i) {
    both.lo[i] = std::max(a.lo[i], b.lo[i]);
    both.hi[i] = std::min(a.hi[i], b.hi[i]);
  }
  return volume(both);
}

}  // namespace

template <int K>
KdopTree<K>::KdopTree(const TriangleSoup& soup, const TreeOptions& options) : soup_(&soup), options_(options) {
  assert(!soup.faces.empty() && options.split_threshold >= 1);
  project_vertices();
  centroids_.reserve(soup.faces.size());
  for (const TriangleSoup::Face& face : soup.faces) {
    const float* const a = projections_[face.corners[0]].data();
    const float* const b = projections_[face.corners[1]].data();
    const float* const c = projections_[face.corners[2]].data();
    const auto middle = [&](std::size_t k) { return 0.25f * a[k] + 0.25f * b[k] + 0.25f * c[k]; };
    centroids_.push_back({middle(0), middle(1), middle(2)});
  }
  order_.resize(soup.faces.size());
  std::iota(order_.begin(), order_.end(), 0u);
  const auto count = static_cast<std::uint32_t>(order_.size());
  nodes_.push_back({bound(0, count), 0, count, count > options.split_threshold ? kUnsplit : kLeaf});
  depth_.push_back(0);
}

template <int K>
void KdopTree<K>::project_vertices() {
  constexpr auto directions = kdop_directions<K>();
  projections_.resize(soup_->vertices.size());
  for (std::size_t v = 0; v < projections_.size(); ++v) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      projections_[v][i] = static_cast<float>(along(directions[i], soup_->vertices[v]));
    }
  }
}

// Rounding to nearest keeps order, so the least rounded projection is the least one, rounded: the float below it is
// below the real number (whose sum was rounded to binary64 before, a 2^-29 of that step).
template <int K>
Kdop<K> KdopTree<K>::bound(std::uint32_t begin, std::uint32_t end) const {
  assert(begin < end && end <= order_.size());
  Projections lo, hi;
  lo.fill(kFloatInfinity);
  hi.fill(-kFloatInfinity);
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const std::uint32_t corner : soup_->faces[order_[i]].corners) {
      const Projections& p = projections_[corner];
      for (std::size_t s = 0; s < p.size(); ++s) {
        lo[s] = p[s] < lo[s] ? p[s] : lo[s];
        hi[s] = p[s] > hi[s] ? p[s] : hi[s];
      }
    }
  }
  Kdop<K> out;
  for (std::size_t s = 0; s < K / 2; ++s) {
    out.lo[s] = std::nextafter(lo[s], -kFloatInfinity);
    out.hi[s] = std::nextafter(hi[s], kFloatInfinity);
  }
  return out;
}

template <int K>
void KdopTree<K>::split(std::uint32_t i) {
  const Node node = nodes_[i];
  const std::uint32_t depth = depth_[i];
  const std::uint32_t middle = partition(node, depth);
  assert(node.left == kUnsplit && middle > node.begin && middle < node.end);
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  const auto state = [&](std::uint32_t count) { return count > options_.split_threshold ? kUnsplit : kLeaf; };
  nodes_.push_back({bound(node.begin, middle), node.begin, middle, state(middle - node.begin)});
  nodes_.push_back({bound(middle, node.end), middle, node.end, state(node.end - middle)});
  depth_.insert(depth_.end(), 2, depth + 1);
  nodes_[i].left = left;
  assert(contains(nodes_[i].dop, nodes_[left].dop) && contains(nodes_[i].dop, nodes_[left + 1].dop));
}

// The first triangle of the right child; both children get at least one.
template <int K>
std::uint32_t KdopTree<K>::partition(const Node& node, std::uint32_t depth) {
  SplitRule rule = options_.rule;
  if (rule == SplitRule::kCombinedLongestSide)
    rule = depth < kCombinedLevels ? SplitRule::kMinSum : SplitRule::kLongestSide;
  if (rule == SplitRule::kCombinedSplatter) rule = depth < kCombinedLevels ? SplitRule::kMinSum : SplitRule::kSplatter;
  std::uint32_t middle = node.begin;
  int axis = longest_side(node);
  if (rule == SplitRule::kBinnedSah) {
    middle = partition_by_area(node);
  } else {
    const Centroid at = mean(node);
    if (rule == SplitRule::kSplatter) axis = largest_variance(node, at);
    if (rule != SplitRule::kSplatter && rule != SplitRule::kLongestSide) axis = least_volume(node, rule, at);
    middle = partition_at(node, axis, at[static_cast<std::size_t>(axis)]);
  }
  if (middle != node.begin && middle != node.end) return middle;
  // All centroids are at one place, or the mean was rounded beyond them all: half of the triangles each.
  middle = node.begin + (node.end - node.begin) / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const auto k = static_cast<std::size_t>(axis);
    return centroids_[a][k] != centroids_[b][k] ? centroids_[a][k] < centroids_[b][k] : a < b;
  };
  std::nth_element(order_.begin() + node.begin, order_.begin() + middle, order_.begin() + node.end, before);
  return middle;
}

template <int K>
std::uint32_t KdopTree<K>::partition_at(const Node& node, int axis, float at) {
  const auto k = static_cast<std::size_t>(axis);
  const auto right = std::partition(order_.begin() + node.begin, order_.begin() + node.end,
                                    [&](std::uint32_t t) { return centroids_[t][k] <= at; });
  return static_cast<std::uint32_t>(right - order_.begin());
}

template <int K>
typename KdopTree<K>::Centroid KdopTree<K>::mean(const Node& node) const {
  assert(node.begin < node.end);
  std::array<double, 3> sum = {0.0, 0.0, 0.0};
  for (const std::uint32_t t : triangles(node)) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += centroids_[t][k];
  }
  const double count = node.end - node.begin;
  return {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count), static_cast<float>(sum[2] / count)};
}

template <int K>
int KdopTree<K>::longest_side(const Node& node) const {
  int longest = 0;
  for (int k = 1; k < 3; ++k) {
    const auto side = [&](int i) {
      return node.dop.hi[static_cast<std::size_t>(i)] - node.dop.lo[static_cast<std::size_t>(i)];
    };
    if (side(k) > side(longest)) longest = k;
  }
  return longest;
}

template <int K>
int KdopTree<K>::largest_variance(const Node& node, const Centroid& mean) const {
  std::array<double, 3> variance = {0.0, 0.0, 0.0};
  for (const std::uint32_t t : triangles(node)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double off = static_cast<double>(centroids_[t][k]) - static_cast<double>(mean[k]);
      variance[k] += off * off;
    }
  }
  return static_cast<int>(std::ranges::max_element(variance) - variance.begin());
}

template <int K>
int KdopTree<K>::least_volume(const Node& node, SplitRule rule, const Centroid& mean) {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t middle = partition_at(node, axis, mean[static_cast<std::size_t>(axis)]);
    if (middle == node.begin || middle == node.end) continue;
    const Kdop<K> left = bound(node.begin, middle), right = bound(middle, node.end);
    const double cost = rule == SplitRule::kLeastOverlap ? shared_volume<K>(left, right)
                        : rule == SplitRule::kMinMax     ? std::max(volume(widened(left)), volume(widened(right)))
                                                         : volume(widened(left)) + volume(widened(right));
    if (cost < least) {
      least = cost;
      best = axis;
    }
  }
  return best;
}

template <int K>
std::uint32_t KdopTree<K>::partition_by_area(const Node& node) {
  AreaBox of_centroids;
  for (const std::uint32_t t : triangles(node)) of_centroids.merge(centroids_[t].data());
  double least_cost = std::numeric_limits<double>::infinity();
  int axis = -1;
  std::size_t after = 0;
  const auto bin_of = [&](std::uint32_t t, std::size_t k) {
    const double least = of_centroids.lo[k], width = of_centroids.hi[k] - least;
    const double place = (centroids_[t][k] - least) / width * static_cast<double>(kBins);
    return std::min(kBins - 1, static_cast<std::size_t>(place));
  };
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(of_centroids.hi[k] > of_centroids.lo[k])) continue;
    std::array<Bin, kBins> bins;
    for (const std::uint32_t t : triangles(node)) {
      Bin& bin = bins[bin_of(t, k)];
      ++bin.count;
      for (const std::uint32_t corner : soup_->faces[t].corners) bin.box.merge(projections_[corner].data());
    }
    std::array<double, kBins> right_cost;
    Bin right;
    for (std::size_t b = kBins - 1; b > 0; --b) {
      right.box.merge(bins[b].box);
      right.count += bins[b].count;
      right_cost[b] = right.box.half_area() * right.count;
    }
    Bin left;
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
      left.box.merge(bins[b].box);
      left.count += bins[b].count;
      const double cost = left.box.half_area() * left.count + right_cost[b + 1];
      if (cost < least_cost && left.count > 0 && left.count < node.end - node.begin) {
        least_cost = cost;
        axis = static_cast<int>(k);
        after = b;
      }
    }
  }
  if (axis < 0) return node.begin;
  const auto right = std::partition(order_.begin() + node.begin, order_.begin() + node.end, [&](std::uint32_t t) {
    return bin_of(t, static_cast<std::size_t>(axis)) <= after;
  });
  return static_cast<std::uint32_t>(right - order_.begin());
}

template <int K>
void KdopTree<K>::build_all() {
  nodes_.reserve(2 * order_.size());
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) (void)children(i);
}

template <int K>
void KdopTree<K>::refit(const TriangleSoup& soup) {
  assert(soup.faces.size() == soup_->faces.size());
  soup_ = &soup;
  project_vertices();
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children stand behind their parents
    Node& node = nodes_[i];
    if (node.left >= kUnsplit) {
      node.dop = bound(node.begin, node.end);
    } else {
      node.dop = nodes_[node.left].dop;
      assert(node.left > i && node.left + 1 < nodes_.size());
      node.dop.merge(nodes_[node.left + 1].dop);
    }
  }
}

template <int K>
std::uint32_t KdopTree<K>::height() const {
  return *std::ranges::max_element(depth_);
}

template <int K>
std::size_t KdopTree<K>::memory_bytes() const {
  return nodes_.capacity() * sizeof(Node) + depth_.capacity() * sizeof(std::uint32_t) +
         order_.capacity() * sizeof(std::uint32_t) + projections_.capacity() * sizeof(projections_[0]) +
         centroids_.capacity() * sizeof(Centroid);
}

template class KdopTree<6>;
template class KdopTree<14>;
template class KdopTree<18>;
template class KdopTree<26>;

}  // namespace peerd::collision
