#include "collision_hull.hpp"

#include <libqhull_r/qhull_ra.h>

#include <Eigen/Eigenvalues>
#include <cstdio>
#include <numbers>

#include "core/box.hpp"
#include "generated_text.hpp"

namespace peerd::bench {

std::optional<Hull> convex_hull(std::span<const Vec3> points) {
  std::vector<coordT> coordinates;
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p[0], p[1], p[2]});
  qhT state{};
  qh_zero(&state, stderr);
  char command[] = "qhull FA";  // with the volume
  std::FILE* const quiet = std::tmpfile();
  const bool failed =
      qh_new_qhull(&state, 3, static_cast<int>(points.size()), coordinates.data(), False, command, quiet, quiet) != 0;
  std::optional<Hull> out;
  if (!failed) {
    out.emplace();
    out->volume_m3 = state.totvol;
    for (const vertexT* v = state.vertex_list; v != nullptr && v->next != nullptr; v = v->next) {
      out->vertices.emplace_back(v->point[0], v->point[1], v->point[2]);
    }
  }
  qh_freeqhull(&state, !qh_ALL);
  int blocks = 0, bytes = 0;
  qh_memfreeshort(&state, &blocks, &bytes);
  if (quiet != nullptr) std::fclose(quiet);
  return out;
}

double oriented_box_volume(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
  const auto volume = [&](const Quat& turn) {
    const Mat3 rotation = turn.toRotationMatrix();
    WorldBox box;
    for (const Vec3& p : points) box.merge(Vec3(rotation * p));
    return (box.hi - box.lo).prod();
  };
  Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvectors().transpose();
  if (axes.determinant() < 0) axes.row(0) *= -1;
  Random random(17);
  double least = std::numeric_limits<double>::infinity();
  for (const Quat& start : {Quat(axes), Quat::Identity(), quat_exp(Vec3(0.7, 0.3, 0.5))}) {
    Quat best = start;
    double of_best = volume(best);
    for (double step = 0.5; step > 1e-4;) {
      bool smaller = false;
      for (int i = 0; i < 24 && !smaller; ++i) {
        const double x = random.real(-step, step), y = random.real(-step, step), z = random.real(-step, step);
        const Quat next = (quat_exp(Vec3(x, y, z)) * best).normalized();
        const double of_next = volume(next);
        smaller = of_next < of_best;
        if (smaller) best = next, of_best = of_next;
      }
      if (!smaller) step /= 2;
    }
    least = std::min(least, of_best);
  }
  return least;
}

double ball_volume(std::span<const Vec3> points) {
  Vec3 center = points[0];
  double radius = 0;
  for (int i = 1; i <= 5'000; ++i) {
    const Vec3* farthest = points.data();
    for (const Vec3& p : points) {
      if ((p - center).squaredNorm() > (*farthest - center).squaredNorm()) farthest = &p;
    }
    radius = (*farthest - center).norm();
    center += (*farthest - center) / (i + 1);
  }
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

}  // namespace peerd::bench
